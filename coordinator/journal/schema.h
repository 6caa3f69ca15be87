#ifndef DEPTHFARM_COORDINATOR_JOURNAL_SCHEMA_H_
#define DEPTHFARM_COORDINATOR_JOURNAL_SCHEMA_H_

#include <cstdint>

#include "common/base/status.h"
#include "coordinator/journal/database.h"

namespace depthfarm {

// The tables of a journal, of this version and of all before.
inline constexpr std::int64_t kJournalVersion = 2;

// The version that the database says to be of; 0: it has no tables yet. kCorrupt: it is no journal; kIncompatible: a
// newer depthfarm made it.
[[nodiscard]] Result<std::int64_t> JournalVersionOf(Database& database);

// Makes the tables, or changes those of an earlier version step by step. In one synced transaction: whatever happens
// meanwhile, the journal is of the old version with all that was in it, or of this one. Errors: those of the database.
[[nodiscard]] Status BringUpToDate(Database& database, std::int64_t version);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_JOURNAL_SCHEMA_H_
