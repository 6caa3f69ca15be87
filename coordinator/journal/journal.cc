#include "coordinator/journal/journal.h"

#include <utility>

#include "coordinator/journal/database.h"
#include "coordinator/journal/frame_codec.h"
#include "coordinator/journal/schema.h"

namespace depthfarm {
namespace {

constexpr const char* kColumns = "id, algorithm_version, output_dir, submission, state, status, ended";

std::int64_t Number(JobId id) { return static_cast<std::int64_t>(id.value()); }

Result<JournaledJob> JobOf(const Statement& row, const std::string& path) {
  const std::int64_t state = row.Integer(4);
  if (state < 0 || state > static_cast<std::int64_t>(JobState::kCancelled))
    return Corrupt(path + ": job " + std::to_string(row.Integer(0)) + " is in an unknown state");
  return JournaledJob{JobId(static_cast<std::uint64_t>(row.Integer(0))),
                      static_cast<std::uint32_t>(row.Integer(1)),
                      row.Bytes(2),
                      row.Bytes(3),
                      static_cast<JobState>(state),
                      row.Bytes(5),
                      row.Integer(6) > 0};
}

// Writes that must be on the disk before anybody hears of them.
class Synced {
 public:
  explicit Synced(Database& database) : database_(database), status_(database.Execute("PRAGMA synchronous = FULL")) {}
  ~Synced() { (void)database_.Execute("PRAGMA synchronous = NORMAL"); }
  Synced(const Synced&) = delete;
  Synced& operator=(const Synced&) = delete;
  [[nodiscard]] const Status& status() const { return status_; }

 private:
  Database& database_;
  Status status_;
};

}  // namespace

Journal::Journal(std::unique_ptr<Database> database, const JournalOptions& options)
    : database_(std::move(database)), options_(options) {}

Journal::~Journal() = default;

Result<std::unique_ptr<Journal>> Journal::Open(const std::string& path, const JournalOptions& options,
                                               bool may_create) {
  DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<Database> database, Database::Open(path, may_create, options.vfs));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t version, JournalVersionOf(*database));
  DEPTHFARM_RETURN_IF_ERROR(BringUpToDate(*database, version));
  return std::unique_ptr<Journal>(new Journal(std::move(database), options));
}

Status Journal::Admit(const JournaledJob& job, const CommittedFrames& committed) {
  const Synced synced(*database_);
  DEPTHFARM_RETURN_IF_ERROR(synced.status());
  DEPTHFARM_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*database_));
  DEPTHFARM_RETURN_IF_ERROR(database_->Prepare("INSERT OR REPLACE INTO jobs VALUES (?, ?, ?, ?, ?, x'', 0, 1)")
                                .Bind(Number(job.id))
                                .Bind(job.algorithm_version)
                                .BindText(job.output_dir)
                                .BindBlob(job.submission)
                                .Bind(static_cast<std::int64_t>(job.state))
                                .Run());
  DEPTHFARM_ASSIGN_OR_RETURN(const CommittedFrames before, Frames(job.id));
  for (const auto& [frame, content] : before) {
    if (!committed.contains(frame)) DEPTHFARM_RETURN_IF_ERROR(Forget(job.id, frame));
  }
  if (!job.output_dir.empty()) {
    DEPTHFARM_RETURN_IF_ERROR(database_
                                  ->Prepare("DELETE FROM frames WHERE job IN (SELECT id FROM jobs WHERE output_dir = ? "
                                            "AND id <> ?)")
                                  .BindText(job.output_dir)
                                  .Bind(Number(job.id))
                                  .Run());
  }
  DEPTHFARM_RETURN_IF_ERROR(database_->Prepare("UPDATE last_job SET id = max(id, ?)").Bind(Number(job.id)).Run());
  return transaction.Commit();
}

Status Journal::Commit(JobId job, int frame, const CommittedFrame& committed) {
  return database_->Prepare("INSERT OR REPLACE INTO frames VALUES (?, ?, ?)")
      .Bind(Number(job))
      .Bind(frame)
      .BindBlob(EncodeFrame(committed))
      .Run();
}

Status Journal::Forget(JobId job, int frame) {
  return database_->Prepare("DELETE FROM frames WHERE job = ? AND frame = ?").Bind(Number(job)).Bind(frame).Run();
}

Status Journal::Cancel(JobId job) {
  const Synced synced(*database_);
  DEPTHFARM_RETURN_IF_ERROR(synced.status());
  return database_->Prepare("UPDATE jobs SET state = ? WHERE id = ? AND ended = 0")
      .Bind(static_cast<std::int64_t>(JobState::kCancelled))
      .Bind(Number(job))
      .Run();
}

Status Journal::End(JobId job, JobState state, const std::string& status, bool keeps_results) {
  const Synced synced(*database_);
  DEPTHFARM_RETURN_IF_ERROR(synced.status());
  DEPTHFARM_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*database_));
  DEPTHFARM_RETURN_IF_ERROR(database_
                                ->Prepare("UPDATE jobs SET state = ?, status = ?, wanted = ?, ended = (SELECT 1 + "
                                          "max(ended) FROM jobs) WHERE id = ?")
                                .Bind(static_cast<std::int64_t>(state))
                                .BindBlob(status)
                                .Bind(state != JobState::kDone || keeps_results ? 1 : 0)
                                .Bind(Number(job))
                                .Run());
  DEPTHFARM_RETURN_IF_ERROR(Trim());
  return transaction.Commit();
}

// Jobs that ended are numbered in the order in which they did. length() does not read the submissions.
Status Journal::Trim() {
  DEPTHFARM_RETURN_IF_ERROR(
      database_
          ->Prepare("UPDATE jobs SET submission = x'' WHERE ended > 0 AND length(submission) > 0 AND (wanted = 0 OR "
                    "ended <= (SELECT ended FROM jobs WHERE ended > 0 AND wanted = 1 ORDER BY ended DESC LIMIT 1 "
                    "OFFSET ?) OR ended <= (SELECT ended FROM jobs WHERE ended > 0 ORDER BY ended DESC LIMIT 1 OFFSET "
                    "?))")
          .Bind(static_cast<std::int64_t>(options_.kept_submissions))
          .Bind(static_cast<std::int64_t>(options_.kept_jobs))
          .Run());
  DEPTHFARM_RETURN_IF_ERROR(
      database_
          ->Prepare("DELETE FROM frames WHERE job IN (SELECT id FROM jobs WHERE ended > 0 AND length(submission) = 0)")
          .Run());
  return database_
      ->Prepare(
          "DELETE FROM jobs WHERE ended > 0 AND ended <= (SELECT ended FROM jobs WHERE ended > 0 ORDER BY ended "
          "DESC LIMIT 1 OFFSET ?)")
      .Bind(static_cast<std::int64_t>(options_.kept_jobs))
      .Run();
}

Status Journal::CheckIntegrity() const {
  Statement rows = database_->Prepare("PRAGMA integrity_check");
  DEPTHFARM_ASSIGN_OR_RETURN(const bool row, rows.Next());
  const std::string found = row ? rows.Bytes(0) : "no answer";
  return found == "ok" ? Status() : Corrupt(database_->path() + ": " + found);
}

Result<std::vector<JournaledJob>> Journal::Jobs() const {
  Statement rows = database_->Prepare(
      "SELECT id, algorithm_version, output_dir, x'', state, status, ended FROM jobs ORDER BY ended, id");
  std::vector<JournaledJob> jobs;
  while (true) {
    DEPTHFARM_ASSIGN_OR_RETURN(const bool row, rows.Next());
    if (!row) return jobs;
    DEPTHFARM_ASSIGN_OR_RETURN(JournaledJob job, JobOf(rows, database_->path()));
    jobs.push_back(std::move(job));
  }
}

Result<std::optional<JournaledJob>> Journal::Find(JobId job) const {
  Statement row = database_->Prepare(std::string("SELECT ") + kColumns + " FROM jobs WHERE id = ?");
  DEPTHFARM_ASSIGN_OR_RETURN(const bool found, row.Bind(Number(job)).Next());
  if (!found) return std::optional<JournaledJob>();
  DEPTHFARM_ASSIGN_OR_RETURN(JournaledJob found_job, JobOf(row, database_->path()));
  return std::optional(std::move(found_job));
}

Result<CommittedFrames> Journal::Frames(JobId job) const {
  Statement rows = database_->Prepare("SELECT frame, committed FROM frames WHERE job = ?");
  rows.Bind(Number(job));
  CommittedFrames frames;
  while (true) {
    DEPTHFARM_ASSIGN_OR_RETURN(const bool row, rows.Next());
    if (!row) return frames;
    Result<CommittedFrame> frame = DecodeFrame(rows.Bytes(1));
    if (!frame.ok()) return frame.status().WithContext(database_->path());
    frames[static_cast<int>(rows.Integer(0))] = std::move(frame).value();
  }
}

Result<JobId> Journal::LastJob() const {
  Statement row = database_->Prepare("SELECT id FROM last_job");
  DEPTHFARM_ASSIGN_OR_RETURN(const bool found, row.Next());
  if (!found) return Corrupt(database_->path() + ": does not say which job was the last");
  return JobId(static_cast<std::uint64_t>(row.Integer(0)));
}

Result<std::string> CheckJournal(const std::string& path) {
  DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<Database> database, Database::Open(path, false));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t version, JournalVersionOf(*database));
  // All that follows reads what every version has.
  const Journal journal(std::move(database), {});
  DEPTHFARM_RETURN_IF_ERROR(journal.CheckIntegrity());
  DEPTHFARM_ASSIGN_OR_RETURN(
      const std::vector<JournaledJob> jobs,
      version == 0 ? Result<std::vector<JournaledJob>>(std::vector<JournaledJob>()) : journal.Jobs());
  std::size_t running = 0;
  std::size_t frames = 0;
  for (const JournaledJob& job : jobs) {
    running += job.ended ? 0 : 1;
    DEPTHFARM_ASSIGN_OR_RETURN(const CommittedFrames committed, journal.Frames(job.id));
    frames += committed.size();
  }
  std::string text = "ok: " + std::to_string(jobs.size()) + (jobs.size() == 1 ? " job, " : " jobs, ") +
                     std::to_string(running) + " of them running, " + std::to_string(frames) + " frames in place";
  if (version != kJournalVersion) {
    text += "; of journal version " + std::to_string(version) + ": the next coordinator makes it version " +
            std::to_string(kJournalVersion);
  }
  return text;
}

}  // namespace depthfarm
