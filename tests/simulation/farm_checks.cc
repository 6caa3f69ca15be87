// What must hold in a simulated farm, whatever happens.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/digest/sha256.h"
#include "common/wire/digest_wire.h"
#include "common/wire/envelope.h"
#include "common/wire/task_wire.h"
#include "tests/simulation/simulated_farm.h"

namespace depthfarm::simulation {
namespace {

namespace fs = std::filesystem;

constexpr int kPatientAttempts = 50;  // so many failures of one task do not come by chance

// Asks the coordinator, without a network.
v1::Envelope Call(Coordinator& coordinator, v1::Envelope request, TimePoint now) {
  request.set_request_id(1);
  (void)coordinator.TakeOutgoing();
  coordinator.Handle({"checks", "", SerializeEnvelope(std::move(request))}, now);
  std::vector<OutgoingMessage> answers = coordinator.TakeOutgoing();
  return answers.empty() ? v1::Envelope() : std::move(answers.front().envelope);
}

// That two workers may have at a time: it makes an artifact and writes nowhere.
bool MayBeDuplicated(const TaskSpec& spec) {
  return MakesArtifact(spec.id.kind) || (spec.output_key && MakesFiles(spec.id.kind));
}

}  // namespace

void SimulatedFarm::Problem(const std::string& text) {
  const auto ms = std::chrono::duration_cast<Milliseconds>(events_.now().time_since_epoch()).count();
  problems_.push_back("at " + std::to_string(ms) + " ms: " + text);
}

void SimulatedFarm::OnBegun(const SimulatedWorker& worker, LeaseId lease, const TaskSpec& spec) {
  first_tasks_.try_emplace(spec.id.job, events_.now());
  // That a lease is one worker's rests on the order that a connection keeps (PROTOCOL.md, 4).
  if (options_.faults.network.reorders) return;
  for (const auto& other : workers_) {
    if (const auto task = other->WorksFor(spec.id.job, lease); task && spec.id.kind == TaskKind::kCleanup)
      Problem(TaskName(spec.id) + " is begun while " + other->name() + " has " + TaskName(*task));
    const std::optional<LeaseId> believed = other->BelievesIn(spec.id, lease);
    if (!believed) continue;
    // One is the duplicate of the other, which a task has one of.
    const bool one_of_two = duplicates_.contains(lease) != duplicates_.contains(*believed);
    if (!one_of_two || !MayBeDuplicated(spec)) {
      Problem(TaskName(spec.id) + " is " + worker.name() + "'s and " + other->name() + "'s at the same time");
    }
  }
}

void SimulatedFarm::OnEnd(const Submitter& submitter, const JobEnd& end) {
  const std::string name = submitter.name() + ", job " + std::to_string(end.id);
  const v1::JobStatus& status = end.status;
  if (status.determinism_violations() > 0) Problem(name + ": determinism was violated");
  tally_.duplicates_won += status.duplicates_won();
  if (status.duplicates_won() > status.duplicates()) Problem(name + ": more duplicates were first than there are");
  for (const v1::StageStatus& stage : status.stages()) {
    const bool all = status.state() == v1::JOB_STATE_DONE;
    if (stage.tasks_done() > stage.tasks_total() || (all && stage.tasks_done() < stage.tasks_total()))
      Problem(name + ": of " + std::to_string(stage.tasks_total()) + " tasks " + std::to_string(stage.tasks_done()) +
              " are done, kind " + std::to_string(stage.kind()));
  }
  // Each life of the coordinator, and each run of the job, tries a task so often, and once beside another attempt.
  const auto most = static_cast<std::uint64_t>(options_.coordinator.max_attempts + 1) * (coordinators_ + 1);
  for (const auto& [task, deaths] : deaths_) {
    if (task.job.value() == end.id && static_cast<std::uint64_t>(deaths) > most)
      Problem(TaskName(task) + " killed " + std::to_string(deaths) + " workers");
  }
  if (status.state() == v1::JOB_STATE_DONE) {
    ++tally_.jobs_done;
    if (status.frames_done() != status.frames_total()) Problem(name + ": is done without all of its frames");
    if (end.cancelled && !end.retried) Problem(name + ": was cancelled, and is done");
    if (end.wish.kind.sequence != "line") Problem(name + ": can't be done, and is");
  } else {
    ++tally_.jobs_ended_otherwise;
    const bool patient = options_.coordinator.max_attempts >= kPatientAttempts;
    if (status.state() == v1::JOB_STATE_FAILED && patient && end.wish.kind.sequence == "line")
      Problem(name + ": failed: " + status.error().message());
    if (status.state() == v1::JOB_STATE_CANCELLED && !end.wish.cancel_after) Problem(name + ": nobody cancelled it");
    if (status.state() == v1::JOB_STATE_FAILED && status.error().message().empty())
      Problem(name + ": failed without a reason");
  }
  if (!calm_) ended_in_chaos_.insert(end.id);
  CheckFolder(submitter, end, false);
}

void SimulatedFarm::NoteEndedInChaos() {
  if (!coordinator_) return;
  v1::Envelope request;
  request.mutable_list_jobs();
  const v1::Envelope list = Call(*coordinator_, request, events_.now());
  for (const v1::JobStatus& job : list.job_list().jobs()) {
    if (job.state() != v1::JOB_STATE_RUNNING) ended_in_chaos_.insert(job.job_id());
  }
}

void SimulatedFarm::CheckFolder(const Submitter& submitter, const JobEnd& end, bool last_look) {
  const std::string name = submitter.name() + ", job " + std::to_string(end.id) + (last_look ? ", at last" : "");
  if (end.wish.kind.keeps_results || !options_.checks_files) return;  // results: CheckJobList
  const FolderContent content = ReadFolder(submitter.FolderOf(end.wish.kind));
  const FolderContent& expected = ExpectedFiles(end.wish.kind, options_.scratch);
  if (end.status.state() == v1::JOB_STATE_DONE) {
    for (const auto& [path, bytes] : content) {
      if (!expected.contains(path)) Problem(name + ": " + path + " should not be there");
    }
    for (const auto& [path, bytes] : expected) {
      const auto found = content.find(path);
      if (found == content.end()) {
        Problem(name + ": " + path + " is missing");
      } else if (found->second != bytes) {
        Problem(name + ": " + path + " is not what it should be");
      }
    }
    return;
  }
  // Files of one job alone: of this one, in part, or of one before.
  std::set<std::string> files;
  for (const auto& [path, bytes] : content) {
    // A Cleanup that no worker could do in time is not waited for.
    if (path.starts_with(".depthfarm-staging/") && last_look &&
        (!ended_in_chaos_.contains(end.id) || cleaned_up_.contains(end.id)))
      Problem(name + ": " + path + " was left behind");
    if (!path.starts_with(".")) files.insert(path);
  }
  const bool finished = content.contains("depth.json") || content.contains("views.json");
  const auto all_of = [&](const FolderContent& whole) {
    return (!finished || files.size() == whole.size()) && std::ranges::all_of(files, [&](const std::string& path) {
             const auto found = whole.find(path);
             return found != whole.end() && found->second == content.at(path);
           });
  };
  bool known = all_of(expected);
  for (const JobEnd& before : submitter.ends())
    known = known || all_of(ExpectedFiles(before.wish.kind, options_.scratch));
  if (!known) Problem(name + ": its folder holds what no job made");
}

void SimulatedFarm::CheckJobList() {
  v1::Envelope request;
  request.mutable_list_jobs();
  const v1::Envelope list = Call(*coordinator_, request, events_.now());
  std::map<std::uint64_t, v1::JobStatus> jobs;
  for (const v1::JobStatus& job : list.job_list().jobs()) jobs[job.job_id()] = job;
  for (const auto& [name, submitter] : submitters_) {
    for (const JobEnd& end : submitter->ends()) {
      const std::string job = name + ", job " + std::to_string(end.id);
      const auto listed = jobs.find(end.id);
      if (listed == jobs.end()) {
        Problem(job + ": was forgotten");
      } else if (listed->second.state() != end.status.state()) {
        Problem(job + ": ended in one way and is listed in another");
      }
      if (!options_.checks_files || !end.wish.kind.keeps_results || end.status.state() != v1::JOB_STATE_DONE) continue;
      JobKind with_folder = end.wish.kind;
      with_folder.keeps_results = false;
      std::set<std::string> wanted;
      for (const auto& [path, bytes] : ExpectedFiles(with_folder, options_.scratch)) {
        if (path.starts_with("depth/") || path.starts_with("confidence/")) wanted.insert(DigestBytes(Sha256(bytes)));
      }
      v1::Envelope ask;
      ask.mutable_get_results()->set_job_id(end.id);
      const v1::Envelope results = Call(*coordinator_, ask, events_.now());
      std::set<std::string> there;
      for (const v1::FrameResult& frame : results.results().frames()) {
        for (const v1::FileDigest& file : frame.files()) there.insert(file.sha256());
      }
      if (there != wanted) Problem(job + ": its results are not what they should be");
    }
  }
}

void SimulatedFarm::CheckAttempts(bool last) {
  v1::Envelope request;
  request.mutable_list_jobs();
  const v1::Envelope list = Call(*coordinator_, request, events_.now());
  for (const v1::JobStatus& job : list.job_list().jobs()) CheckAttemptsOf(job, last);
  if (!disk_.dead()) CheckMetrics(last);  // else what it granted last was never sent
}

void SimulatedFarm::CheckMetrics(bool last) {
  const FarmMetrics metrics = coordinator_->Metrics();
  std::uint64_t ended = 0;
  for (const auto& [kind_and_outcome, count] : metrics.attempts) ended += count;
  if (ended > granted_ || (last && ended < granted_))
    Problem("of " + std::to_string(granted_) + " leases " + std::to_string(ended) + " have ended");
  if (last && metrics.jobs_running + metrics.tasks_leased + metrics.tasks_ready + metrics.gops_unopened > 0)
    Problem("a farm whose jobs have ended wants workers");
}

void SimulatedFarm::CheckAttemptsOf(const v1::JobStatus& job, bool last) {
  const std::string name = "job " + std::to_string(job.job_id());
  if (last && job.state() == v1::JOB_STATE_RUNNING) Problem(name + ": is still running");
  std::set<std::pair<int, int>> committed;
  std::map<TaskId, int> failures;
  for (std::uint64_t after = 0;;) {
    v1::Envelope ask;
    ask.mutable_get_job_logs()->set_job_id(job.job_id());
    ask.mutable_get_job_logs()->set_after(after);
    const v1::Envelope logs = Call(*coordinator_, ask, events_.now());
    for (const v1::TaskAttempt& attempt : logs.job_logs().attempts()) {
      const TaskId task = FromProto(attempt.task()).value();
      const v1::AttemptOutcome outcome = attempt.outcome();
      const int number = static_cast<int>(attempt.attempt());
      if (last && outcome == v1::ATTEMPT_OUTCOME_RUNNING) Problem(TaskName(task) + ": is never over");
      if (number > options_.coordinator.max_attempts) Problem(TaskName(task) + ": was tried too often");
      if (number > 1 + failures[task]) Problem(TaskName(task) + ": what was no failure of it was counted as one");
      if (!attempt.duplicate() && (outcome == v1::ATTEMPT_OUTCOME_FAILED || outcome == v1::ATTEMPT_OUTCOME_EXPIRED ||
                                   outcome == v1::ATTEMPT_OUTCOME_WORKER_LOST))
        ++failures[task];
      if (task.kind == TaskKind::kPrepare) cleaned_up_.erase(job.job_id());  // a new run of it
      if (outcome != v1::ATTEMPT_OUTCOME_DONE) continue;
      if (task.kind == TaskKind::kCleanup) cleaned_up_.insert(job.job_id());
      if (task.kind != TaskKind::kCommit && task.kind != TaskKind::kManifest) continue;
      if (!committed.emplace(static_cast<int>(task.kind), task.frame).second)
        Problem(TaskName(task) + ": was done twice");
      if (task.kind != TaskKind::kCommit) continue;
      if (remembered_.contains({job.job_id(), task.frame})) Problem(TaskName(task) + ": was done in an earlier life");
      if (job.state() == v1::JOB_STATE_RUNNING) written_.emplace(job.job_id(), task.frame);
    }
    after = logs.job_logs().next();
    if (after == 0) break;
  }
}

void SimulatedFarm::CheckJournal(const Journal& journal) {
  remembered_.clear();
  const Result<std::vector<JournaledJob>> jobs = journal.Jobs();
  if (!jobs.ok()) return;  // the coordinator will say so
  for (const JournaledJob& job : *jobs) {
    const Result<CommittedFrames> frames = journal.Frames(job.id);
    if (!frames.ok()) continue;
    for (const auto& [frame, committed] : *frames) remembered_.emplace(job.id.value(), frame);
  }
  for (const auto& [job, frame] : written_) {
    if (!remembered_.contains({job, frame}))
      Problem("job " + std::to_string(job) + " frame " + std::to_string(frame) + ": was committed, and is forgotten");
  }
  written_.clear();
}

void SimulatedFarm::CheckNothingIsLeft() {
  restarting_ = false;
  for (const auto& worker : workers_) worker->Stop();
  const TimePoint end = events_.now() + 4 * Lease();
  while (events_.RunNext(end)) {
  }
  if (!coordinator_->scheduler().empty()) Problem("the coordinator keeps something of a farm that is no more");
}

FolderContent ReadFolder(const std::string& folder) {
  FolderContent content;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.is_directory() && fs::is_empty(entry.path())) content[fs::relative(entry.path(), folder).string() + "/"];
    if (!entry.is_regular_file()) continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    std::ostringstream bytes;
    bytes << stream.rdbuf();
    content[fs::relative(entry.path(), folder).string()] = bytes.str();
  }
  return content;
}

const FolderContent& ExpectedFiles(const JobKind& kind, const std::string& scratch) {
  static std::map<JobKind, FolderContent> known;
  if (kind.sequence != "line") {
    static const FolderContent nothing;
    return nothing;
  }
  const auto found = known.find(kind);
  if (found != known.end()) return found->second;
  SimulatedFarm::Options options;
  options.scratch = scratch + "/expected";
  fs::remove_all(options.scratch);
  options.workers.resize(1);
  options.checks_files = false;
  SimulatedFarm farm(1, options);
  farm.AddSubmitter("only", {Wish{kind}}, Milliseconds(0));
  farm.Run();
  if (!farm.problems().empty()) throw std::logic_error("without faults: " + farm.problems().front());
  known[kind] = ReadFolder(farm.submitters().at("only")->FolderOf(kind));
  fs::remove_all(options.scratch);
  return known[kind];
}

}  // namespace depthfarm::simulation
