#include <cmath>

#include "common/job/job_manifest.h"
#include "common/wire/bounds.h"
#include "common/wire/render_wire.h"
#include "coordinator/cli/logs_report.h"
#include "coordinator/cli/report.h"
#include "coordinator/service/task_filter.h"
#include "tests/fuzz/wire_round_trip.h"
#include "worker/service/messages.h"

namespace {

using namespace depthfarm;
using fuzz::RequireWireRoundTrip;

void TryJob(const v1::JobConfig& proto) {
  const auto config = RequireWireRoundTrip(proto);
  if (!config || config->render) return;
  const ResolvedJob& job = config->resolved;
  fuzz::Require(job.Levels().count() == job.params.levels, "a job has levels");
  fuzz::Require(SearchStep(job, job.level_blocks_i) >= 1, "a search goes on");
  fuzz::Require(!FilesOfFrame(job, job.num_frames - 1).empty(), "a frame has files");
}

void TryFinished(const v1::TaskFinished& message) {
  (void)RequireWireRoundTrip(message.task());
  (void)RequireWireRoundTrip(message.artifact());
  for (const v1::OutputFile& file : message.files()) (void)RequireWireRoundTrip(file);
  const Status error = FromProto(message.error());
  fuzz::Require(error.ok() == (message.error().code() == v1::CODE_OK), "an error stays one");
  const TaskStats stats = FromProto(message.stats());
  fuzz::Require(stats.wall_seconds >= 0 && std::isfinite(stats.cpu_seconds), "statistics are numbers");
  const TaskLog log = FromProto(message.log());
  fuzz::Require(log.lines.size() <= kMaxTaskLogLines, "a log is short");
  fuzz::Require(FromProto(ToProto(log)).lines == log.lines, "a log comes back");
}

void TryHello(const v1::WorkerHello& hello) {
  for (const v1::ArtifactInfo& artifact : hello.artifacts()) (void)RequireWireRoundTrip(artifact);
  (void)CheckTags("worker tags", {hello.tags().begin(), hello.tags().end()});
}

void TryResults(const v1::Results& results) {
  TryJob(results.job());
  for (const v1::FrameResult& frame : results.frames()) (void)RequireWireRoundTrip(frame);
}

void TrySubmission(const v1::SubmitJob& submit) {
  (void)RequireWireRoundTrip(submit.sequence());
  (void)RequireWireRoundTrip(submit.params());
  (void)RequireWireRoundTrip(submit.render().source());
  (void)ViewsFromProto(submit.render().views());
}

// What each side does with a message's content before it acts on it.
void TryBody(const v1::Envelope& envelope) {
  switch (envelope.body_case()) {
    case v1::Envelope::kWorkerHello:
      return TryHello(envelope.worker_hello());
    case v1::Envelope::kTaskFinished:
      return TryFinished(envelope.task_finished());
    case v1::Envelope::kGrantTask:
      (void)RequireWireRoundTrip(envelope.grant_task().task());
      return TryJob(envelope.grant_task().job());
    case v1::Envelope::kReleaseArtifacts:
      return (void)KeysOf(envelope.release_artifacts());
    case v1::Envelope::kKeepArtifacts:
      return (void)KeysOf(envelope.keep_artifacts());
    case v1::Envelope::kSubmitJob:
      return TrySubmission(envelope.submit_job());
    case v1::Envelope::kResults:
      return TryResults(envelope.results());
    case v1::Envelope::kJobStatus:
      (void)JobToJson(envelope.job_status()).dump();
      (void)FormatProgress(envelope.job_status());
      return (void)FormatJob(envelope.job_status());
    case v1::Envelope::kJobList:
      return (void)FormatJobs({envelope.job_list().jobs().begin(), envelope.job_list().jobs().end()});
    case v1::Envelope::kWorkerList:
      for (const v1::WorkerStatus& worker : envelope.worker_list().workers()) (void)WorkerToJson(worker).dump();
      return (void)FormatWorkers({envelope.worker_list().workers().begin(), envelope.worker_list().workers().end()});
    case v1::Envelope::kJobLogs:
      (void)LogsToJson(envelope.job_logs()).dump();
      return (void)FormatLogs(envelope.job_logs());
    case v1::Envelope::kGetJobLogs:
      return (void)TaskFilter::Parse(envelope.get_job_logs().task());
    case v1::Envelope::kError:
      return (void)FromProto(envelope.error());
    default:
      return;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::Text(data, size);
  const auto received = ParseEnvelope(bytes);
  if (received.ok()) fuzz::Require(!BodyName(*received).empty(), "a body has a name");
  // A corpus is to outlive versions of the protocol.
  v1::Envelope any_version;
  if (!any_version.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return 0;
  const auto envelope = ParseEnvelope(SerializeEnvelope(any_version));
  if (envelope.ok()) TryBody(*envelope);
  return 0;
}
