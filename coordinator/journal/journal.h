#ifndef DEPTHFARM_COORDINATOR_JOURNAL_JOURNAL_H_
#define DEPTHFARM_COORDINATOR_JOURNAL_JOURNAL_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "coordinator/scheduling/committed_frame.h"
#include "coordinator/scheduling/snapshot.h"

namespace depthfarm {

class Database;

// A job as the journal keeps it. The texts are what the coordinator gave: the journal does not look into them.
struct JournaledJob {
  JobId id;
  std::uint32_t algorithm_version = 0;  // that made its frames
  std::string output_dir;
  std::string submission;               // empty once it is done with, or forgotten (JournalOptions::kept_submissions)
  JobState state = JobState::kRunning;  // kCancelled before it ended: its submitter asked for the end
  std::string status = {};              // of a job that ended
  bool ended = false;
};

struct JournalOptions {
  std::size_t kept_jobs = 1000;  // that ended, newest first
  // Of jobs that ended and may be asked for more: failed or cancelled ones can go on, results that workers keep can be
  // fetched.
  std::size_t kept_submissions = 100;
  std::string vfs = {};  // SQLite's way to the file, by its registered name; empty: the system's
};

// What must outlive the coordinator, in one SQLite file: jobs, and which of their frames are in place. All else is
// found again: artifacts by asking workers, tasks by planning. One process owns a journal.
//
// A job that is admitted, cancelled or has ended is on the disk when the call returns (fsync). A frame is on the way
// there: it survives the process, and may be lost with the machine; then it is done once more, to the same bytes.
// Errors: kUnavailable with the path and what SQLite says. Not thread-safe.
class Journal {
 public:
  // Opens it, brings one of an earlier version up to date, or makes it if `may_create`; an empty path keeps it in
  // memory. kUnavailable also if another coordinator has it, kIncompatible if a newer version made it, kCorrupt if it
  // is damaged or no journal.
  [[nodiscard]] static Result<std::unique_ptr<Journal>> Open(const std::string& path,
                                                             const JournalOptions& options = {},
                                                             bool may_create = true);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  // A job that is new, or goes on from these frames; others of it are forgotten, and so are all of jobs that had its
  // output folder before.
  [[nodiscard]] Status Admit(const JournaledJob& job, const CommittedFrames& committed = {});
  [[nodiscard]] Status Commit(JobId job, int frame, const CommittedFrame& committed);
  // Its bundle is lost.
  [[nodiscard]] Status Forget(JobId job, int frame);
  // What was asked for must be done, also by the next coordinator.
  [[nodiscard]] Status Cancel(JobId job);
  // Forgets submission and frames of a job that is done, unless workers keep its results, and older jobs beyond the
  // bounds.
  [[nodiscard]] Status End(JobId job, JobState state, const std::string& status, bool keeps_results = false);
  // kCorrupt names the first damage that SQLite finds.
  [[nodiscard]] Status CheckIntegrity() const;
  // Without their submissions; those that have not ended first, by id, then the others in the order in which they
  // ended.
  [[nodiscard]] Result<std::vector<JournaledJob>> Jobs() const;
  // Empty when there is no such job.
  [[nodiscard]] Result<std::optional<JournaledJob>> Find(JobId job) const;
  [[nodiscard]] Result<CommittedFrames> Frames(JobId job) const;
  // The largest id of all jobs that there ever were; 0: none.
  [[nodiscard]] Result<JobId> LastJob() const;

 private:
  friend Result<std::string> CheckJournal(const std::string& path);
  Journal(std::unique_ptr<Database> database, const JournalOptions& options);
  [[nodiscard]] Status Trim();

  std::unique_ptr<Database> database_;
  const JournalOptions options_;
};

// "ok: 3 jobs, 1 of them running, 120 frames in place", and its version if that is an earlier one; opens a journal that
// is there as Open does, reads all of it and changes nothing.
[[nodiscard]] Result<std::string> CheckJournal(const std::string& path);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_JOURNAL_JOURNAL_H_
