// A coordinator that is started again: from opening the journal to the first task that a worker is given.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/digest/sha256.h"
#include "common/wire/envelope.h"
#include "common/wire/job_wire.h"
#include "common/wire/sequence_wire.h"
#include "coordinator/journal/journal.h"
#include "coordinator/service/coordinator.h"
#include "tests/benchmarks/benchmarks.h"
#include "tests/coordinator/service/small_sequence.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm::benchmarks {
namespace {

constexpr int kViews = 3;
constexpr const char* kPeer = "worker";

TimePoint Now() { return std::chrono::steady_clock::now(); }

PeerMessage From(v1::Envelope envelope) { return {kPeer, "", SerializeEnvelope(std::move(envelope))}; }

std::unique_ptr<Coordinator> Start(const std::string& journal, std::uint64_t first_lease) {
  Result<std::unique_ptr<Journal>> opened = Journal::Open(journal);
  if (!opened.ok()) return nullptr;
  auto coordinator = std::make_unique<Coordinator>(CoordinatorOptions(), first_lease, std::move(opened).value(), false);
  return coordinator->Restore(Now()).ok() ? std::move(coordinator) : nullptr;
}

v1::Envelope Submission(int frames) {
  EstimationParams params;
  params.gop = 10;
  params.levels = 16;
  params.level_blocks = 2;
  params.refine_rounds = 2;
  v1::Envelope envelope;
  *envelope.mutable_submit_job()->mutable_sequence() = ToProto(SmallSequence(kViews, frames));
  *envelope.mutable_submit_job()->mutable_params() = ToProto(params);
  envelope.mutable_submit_job()->set_output_dir("/out");
  return envelope;
}

// A job of so many frames, half of them in place; the number of its tasks, 0 if that failed.
std::uint64_t WriteJournal(const std::string& path, int frames) {
  const std::unique_ptr<Coordinator> coordinator = Start(path, 1);
  if (!coordinator) return 0;
  coordinator->Handle(From(Submission(frames)), Now());
  const std::vector<OutgoingMessage> answers = coordinator->TakeOutgoing();
  if (answers.empty() || !answers.front().envelope.has_job_accepted()) return 0;
  const JobId job(answers.front().envelope.job_accepted().job_id());
  const std::optional<JobSnapshot> snapshot = coordinator->scheduler().Job(job);
  std::uint64_t tasks = 0;
  if (snapshot) {
    for (const StageSnapshot& stage : snapshot->stages) tasks += stage.tasks_total;
  }
  return tasks;
}

bool CommitHalf(const std::string& path, int frames) {
  const Result<std::unique_ptr<Journal>> journal = Journal::Open(path);
  if (!journal.ok()) return false;
  const CommittedFrame frame{.files = std::vector<FileDigest>(kViews, FileDigest{Sha256("depth"), 5}),
                             .picture_digests = std::vector<ContentDigest>(kViews, Sha256("picture"))};
  for (int f = 0; f < frames / 2; ++f) {
    if (!(*journal)->Commit(JobId(1), f, frame).ok()) return false;
  }
  return true;
}

// Whether a worker that joins and asks is given a task.
bool GrantsTask(Coordinator& coordinator) {
  v1::Envelope hello;
  hello.mutable_worker_hello()->set_name("worker");
  hello.mutable_worker_hello()->set_algorithm_version(kAlgorithmVersion);
  hello.mutable_worker_hello()->set_artifact_endpoint("tcp://worker:1");
  coordinator.Handle(From(hello), Now());
  v1::Envelope ask;
  ask.mutable_ask_for_task()->set_ask_id(1);
  coordinator.Handle(From(ask), Now());
  for (const OutgoingMessage& message : coordinator.TakeOutgoing()) {
    if (message.envelope.has_grant_task()) return true;
  }
  return false;
}

void MeasureRestart(benchmark::State& state, int frames, bool& failed) {
  const testing_support::TemporaryFolder folder;
  const std::string path = folder.File("journal.sqlite");
  const std::uint64_t tasks = WriteJournal(path, frames);
  bool right = tasks > 0 && CommitHalf(path, frames);
  std::uint64_t life = 1;
  for (auto _ : state) {
    std::unique_ptr<Coordinator> coordinator = Start(path, ++life << 24U);
    right = right && coordinator && GrantsTask(*coordinator);
    state.PauseTiming();
    coordinator.reset();
    state.ResumeTiming();
  }
  state.counters["tasks"] = static_cast<double>(tasks);
  if (!right) {
    failed = true;
    state.SkipWithError("the coordinator did not go on with its job");
  }
}

}  // namespace

void RegisterRestartBenchmarks(int frames, bool& failed) {
  const std::string name = "CoordinatorRestart/" + std::to_string(frames) + "_frames";
  benchmark::RegisterBenchmark(name.c_str(), [frames, &failed](benchmark::State& state) {
    MeasureRestart(state, frames, failed);
  })->Unit(benchmark::kMillisecond);
}

}  // namespace depthfarm::benchmarks
