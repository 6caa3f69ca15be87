#include "coordinator/journal/schema.h"

#include <array>
#include <string>

namespace depthfarm {
namespace {

constexpr std::int64_t kApplicationId = 0x64666a31;  // "dfj1": what `file` and other programs may know it by

constexpr const char* kTables = R"(
CREATE TABLE jobs (id INTEGER PRIMARY KEY, algorithm_version INTEGER NOT NULL, output_dir TEXT NOT NULL,
                   submission BLOB NOT NULL, state INTEGER NOT NULL, status BLOB NOT NULL, ended INTEGER NOT NULL,
                   wanted INTEGER NOT NULL);
CREATE INDEX jobs_of_folder ON jobs (output_dir);
CREATE TABLE frames (job INTEGER NOT NULL, frame INTEGER NOT NULL, committed BLOB NOT NULL,
                     PRIMARY KEY (job, frame)) WITHOUT ROWID;
CREATE TABLE last_job (id INTEGER NOT NULL);
INSERT INTO last_job VALUES (0);
)";

Result<std::int64_t> Number(Database& database, const std::string& sql) {
  Statement statement = database.Prepare(sql);
  DEPTHFARM_ASSIGN_OR_RETURN(const bool row, statement.Next());
  return row ? statement.Integer(0) : 0;
}

// 1 to 2: whether anybody may want to go on with a job that ended. Journals of version 1 were written with that column
// and, at first, without. Without it, jobs that were done had dropped what going on takes.
Status AddWanted(Database& database) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t there,
                             Number(database, "SELECT count(*) FROM pragma_table_info('jobs') WHERE name = 'wanted'"));
  if (there != 0) return {};
  return database.Execute(
      "ALTER TABLE jobs ADD COLUMN wanted INTEGER NOT NULL DEFAULT 1;"
      "UPDATE jobs SET wanted = 0 WHERE state = 1");  // JobState::kDone
}

// Step i makes version i + 2 of version i + 1.
constexpr std::array<Status (*)(Database&), kJournalVersion - 1> kSteps = {AddWanted};

Status InTransaction(Database& database, std::int64_t version) {
  DEPTHFARM_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(database));
  if (version == 0) {
    DEPTHFARM_RETURN_IF_ERROR(
        database.Execute(std::string(kTables) + "PRAGMA application_id = " + std::to_string(kApplicationId)));
  } else {
    for (std::int64_t of = version; of < kJournalVersion; ++of) {
      DEPTHFARM_RETURN_IF_ERROR(kSteps[static_cast<std::size_t>(of - 1)](database));
    }
  }
  DEPTHFARM_RETURN_IF_ERROR(database.Execute("PRAGMA user_version = " + std::to_string(kJournalVersion)));
  return transaction.Commit();
}

}  // namespace

Result<std::int64_t> JournalVersionOf(Database& database) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t application, Number(database, "PRAGMA application_id"));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t version, Number(database, "PRAGMA user_version"));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t tables, Number(database, "SELECT count(*) FROM sqlite_master"));
  if (tables == 0) return std::int64_t{0};
  if (application != kApplicationId || version < 1) return Corrupt(database.path() + ": is not a journal of depthfarm");
  if (version > kJournalVersion) {
    return Status(ErrorCode::kIncompatible, database.path() + ": was made by a newer depthfarm (journal version " +
                                                std::to_string(version) + ", this one knows " +
                                                std::to_string(kJournalVersion) + ")");
  }
  return version;
}

Status BringUpToDate(Database& database, std::int64_t version) {
  if (version == kJournalVersion) return {};
  DEPTHFARM_RETURN_IF_ERROR(database.Execute("PRAGMA synchronous = FULL"));
  const Status changed = InTransaction(database, version);
  DEPTHFARM_RETURN_IF_ERROR(database.Execute("PRAGMA synchronous = NORMAL"));
  return changed;
}

}  // namespace depthfarm
