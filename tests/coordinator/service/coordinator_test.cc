#include <gtest/gtest.h>

#include <string>

#include "common/transport/farm_keys.h"
#include "coordinator/service/coordinator_server.h"
#include "tests/coordinator/service/fake_peers.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using testing_support::TemporaryFolder;

CoordinatorOptions On(const TemporaryFolder& folder) { return {.endpoint = "ipc://" + folder.File("c")}; }

TEST(Coordinator, DrivesAJobOfTwoGopsToItsEndOverASocket) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakePeer client(context, coordinator.endpoint());
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1");
  worker.Hello();
  EXPECT_EQ(worker.peer.Await(v1::Envelope::kWorkerWelcome).worker_welcome().lease_ms(), 6000U);
  worker.Ask();
  const v1::Envelope accepted = client.Call(SubmitRequest(4, "/out/a/"));
  ASSERT_TRUE(accepted.has_job_accepted()) << accepted.error().message();
  EXPECT_EQ(accepted.request_id(), 1U);
  // Prepare, Manifest; per frame 3 Analyse, 2 Estimate, 1 Merge, 2 x 3 Refine, Emit, Commit.
  EXPECT_EQ(worker.WorkUntilJobEnds(), 2 + 4 * 14);

  const v1::Envelope answer = client.Call(StatusRequest(accepted.job_accepted().job_id()));
  EXPECT_EQ(answer.request_id(), 77U);
  const v1::JobStatus& status = answer.job_status();
  EXPECT_EQ(status.state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(status.frames_done(), 4U);
  EXPECT_EQ(status.output_dir(), "/out/a");
  EXPECT_EQ(status.summary(), "3 views 64x48, 459 segments, 16 levels, n = 2 interleaved");
  EXPECT_EQ(status.stages_size(), 8);
  for (const v1::StageStatus& stage : status.stages()) EXPECT_EQ(stage.tasks_done(), stage.tasks_total());
}

TEST(Coordinator, ListsJobsInPagesToWhoAsksForThem) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakePeer client(context, coordinator.endpoint());
  for (const char* const output : {"/out/a", "/out/b", "/out/c"}) (void)client.Call(SubmitRequest(2, output));
  // The second one has ended, the others have not.
  v1::Envelope request;
  request.mutable_cancel_job()->set_job_id(2);
  ASSERT_TRUE(client.Call(request).has_done());

  const auto list = [&](std::uint32_t max_jobs, std::uint64_t after) {
    v1::Envelope ask;
    ask.mutable_list_jobs()->set_max_jobs(max_jobs);
    ask.mutable_list_jobs()->set_after(after);
    return client.Call(ask).job_list();
  };
  const v1::JobList first = list(2, 0);
  ASSERT_EQ(first.jobs_size(), 2);
  EXPECT_EQ(first.jobs(0).job_id(), 1U);
  EXPECT_EQ(first.jobs(1).job_id(), 2U);
  EXPECT_EQ(first.jobs(1).state(), v1::JOB_STATE_CANCELLED);
  EXPECT_EQ(first.next(), 2U);
  const v1::JobList last = list(2, first.next());
  ASSERT_EQ(last.jobs_size(), 1);
  EXPECT_EQ(last.jobs(0).job_id(), 3U);
  EXPECT_EQ(last.next(), 0U);
  // A client of an older version asks for nothing of the kind.
  EXPECT_EQ(list(0, 0).jobs_size(), 3);
  EXPECT_EQ(list(0, 0).next(), 0U);
}

TEST(Coordinator, ListsJobsAndWorkersAndCancels) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakePeer client(context, coordinator.endpoint());
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1");
  worker.Hello();
  worker.Ask();
  (void)worker.peer.Await(v1::Envelope::kWorkerWelcome);
  const std::uint64_t job = client.Call(SubmitRequest(2, "/out/a")).job_accepted().job_id();
  const v1::Envelope grant = worker.peer.Await(v1::Envelope::kGrantTask);
  EXPECT_EQ(grant.grant_task().task().id().kind(), v1::TASK_KIND_PREPARE);

  v1::Envelope request;
  request.mutable_list_workers();
  const v1::Envelope workers = client.Call(request);
  ASSERT_EQ(workers.worker_list().workers_size(), 1);
  EXPECT_EQ(workers.worker_list().workers(0).name(), "w1");
  EXPECT_EQ(workers.worker_list().workers(0).running(), "job 1 prepare");
  request.mutable_list_jobs();
  EXPECT_EQ(client.Call(request).job_list().jobs(0).running(0), "prepare on w1");
  request.mutable_get_backlog();
  const v1::Envelope backlog = client.Call(request);
  ASSERT_TRUE(backlog.has_backlog());
  EXPECT_EQ(backlog.backlog().leased(), 1U);
  EXPECT_EQ(backlog.backlog().ready(), 3U) << "the first GOP is open: its views can be analysed";
  request.mutable_get_backlog()->add_tags("no tag");
  EXPECT_EQ(client.Call(request).error().code(), v1::CODE_INVALID_ARGUMENT);

  request.mutable_cancel_job()->set_job_id(job);
  EXPECT_TRUE(client.Call(request).has_done());
  EXPECT_EQ(worker.peer.Await(v1::Envelope::kRevokeLease).revoke_lease().lease_id(), grant.grant_task().lease_id());
  worker.Report(grant.grant_task());  // it was done by then
  worker.Ask();
  const v1::Envelope cleanup = worker.peer.Await(v1::Envelope::kGrantTask);
  EXPECT_EQ(cleanup.grant_task().task().id().kind(), v1::TASK_KIND_CLEANUP);
  worker.Report(cleanup.grant_task());
  (void)worker.peer.Await(v1::Envelope::kJobEnded);
  EXPECT_EQ(client.Call(StatusRequest(job)).job_status().state(), v1::JOB_STATE_CANCELLED);
  EXPECT_EQ(client.Call(request).error().code(), v1::CODE_INVALID_ARGUMENT);  // it has ended
}

TEST(Coordinator, BadRequestsAreAnsweredWithTheReason) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakePeer client(context, coordinator.endpoint());
  client.SendBytes("rubbish");
  EXPECT_TRUE(client.Receive().has_error());
  client.SendBytes("");
  EXPECT_EQ(client.Receive().error().code(), v1::CODE_INCOMPATIBLE);
  EXPECT_EQ(client.Call(StatusRequest(9)).error().code(), v1::CODE_INVALID_ARGUMENT);
  const v1::Envelope relative = client.Call(SubmitRequest(2, "out"));
  EXPECT_EQ(relative.error().code(), v1::CODE_INVALID_ARGUMENT);
  EXPECT_EQ(relative.request_id(), 1U);
  v1::Envelope chunk;
  chunk.mutable_get_chunk();
  EXPECT_NE(client.Call(chunk).error().message().find("get_chunk"), std::string::npos);
}

TEST(Coordinator, AFolderBelongsToOneJobHoweverItIsSpelt) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakePeer client(context, coordinator.endpoint());
  EXPECT_TRUE(client.Call(SubmitRequest(2, "/out/a")).has_job_accepted());
  EXPECT_NE(client.Call(SubmitRequest(2, "/out/b/../a//")).error().message().find("job 1 writes to /out/a"),
            std::string::npos);
  EXPECT_TRUE(client.Call(SubmitRequest(2, "/out/b")).has_job_accepted());
}

TEST(Coordinator, AWorkerThatIsNotKnownIsToldToSayHello) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1");
  worker.Ask();
  EXPECT_EQ(worker.peer.Receive().error().code(), v1::CODE_UNAVAILABLE);
}

// As on a farm that is being upgraded: it waits for jobs of its version, the others do those of theirs.
TEST(Coordinator, AWorkerOfAnotherAlgorithmIsWelcomeAndGetsNoTask) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakePeer other(context, coordinator.endpoint());
  v1::Envelope hello;
  hello.mutable_worker_hello()->set_name("other");
  hello.mutable_worker_hello()->set_artifact_endpoint("ipc:///x");
  hello.mutable_worker_hello()->set_algorithm_version(kAlgorithmVersion + 1);
  EXPECT_TRUE(other.Call(hello).has_worker_welcome());
  FakePeer client(context, coordinator.endpoint());
  const auto job = client.Call(SubmitRequest(2, "/out/a")).job_accepted().job_id();
  v1::Envelope ask;
  ask.mutable_ask_for_task()->set_ask_id(1);
  other.Send(ask);
  EXPECT_FALSE(other.TryReceive().has_value());
  const v1::JobStatus waiting = client.Call(StatusRequest(job)).job_status();
  EXPECT_TRUE(waiting.lacks_worker());
  EXPECT_EQ(waiting.algorithm_version(), kAlgorithmVersion);
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1");
  worker.Hello();
  EXPECT_TRUE(worker.peer.Await(v1::Envelope::kWorkerWelcome).has_worker_welcome());
  worker.Ask();
  EXPECT_GT(worker.WorkUntilJobEnds(), 0);
  EXPECT_EQ(client.Call(StatusRequest(job)).job_status().state(), v1::JOB_STATE_DONE);
  v1::Envelope list;
  list.mutable_list_workers();
  const v1::WorkerList workers = client.Call(list).worker_list();
  ASSERT_EQ(workers.workers_size(), 2);
  EXPECT_EQ(workers.workers(0).algorithm_version() + workers.workers(1).algorithm_version(), 2 * kAlgorithmVersion + 1);
}

TEST(Coordinator, AStatusThatWaitsIsAnsweredWhenTheJobHasEndedOrItsTimeIsOver) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakePeer client(context, coordinator.endpoint());
  const auto ask = [&](std::uint64_t request_id, std::uint64_t job_id, std::uint32_t wait_ms) {
    v1::Envelope question;
    question.set_request_id(request_id);
    question.mutable_get_job_status()->set_job_id(job_id);
    question.mutable_get_job_status()->set_wait_ms(wait_ms);
    client.Send(std::move(question));
  };
  client.Send(SubmitRequest(1, "/out/a"));
  const std::uint64_t job = client.Await(v1::Envelope::kJobAccepted).job_accepted().job_id();
  ask(11, job, 1);
  const v1::Envelope in_time = client.Await(v1::Envelope::kJobStatus);
  EXPECT_EQ(in_time.request_id(), 11U);
  EXPECT_EQ(in_time.job_status().state(), v1::JOB_STATE_RUNNING);
  ask(12, 99, 10'000);
  EXPECT_EQ(client.Await(v1::Envelope::kError).request_id(), 12U) << "an unknown job does not end";

  ask(13, job, 10'000);
  ask(14, job, 0);  // who does not wait is not held up
  EXPECT_EQ(client.Await(v1::Envelope::kJobStatus).request_id(), 14U);
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1");
  worker.Hello();
  worker.Ask();
  EXPECT_GT(worker.WorkUntilJobEnds(), 0);
  const v1::Envelope at_end = client.Await(v1::Envelope::kJobStatus);
  EXPECT_EQ(at_end.request_id(), 13U);
  EXPECT_EQ(at_end.job_status().state(), v1::JOB_STATE_DONE);
  ask(15, job, 10'000);
  EXPECT_EQ(client.Await(v1::Envelope::kJobStatus).request_id(), 15U) << "it has ended";
}

// A peer of the next minor version says what this one does not know, in fields and in messages.
TEST(Coordinator, APeerOfTheNextMinorVersionIsServedAndToldWhatIsNotKnown) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  const auto as_later = [](v1::Envelope envelope, bool with_body) {
    envelope.set_protocol_version(kProtocolVersion);
    envelope.set_protocol_minor(kProtocolMinor + 1);
    envelope.GetReflection()->MutableUnknownFields(&envelope)->AddLengthDelimited(4000, "new");
    if (with_body && envelope.has_submit_job()) {
      v1::SubmitJob* job = envelope.mutable_submit_job();
      job->GetReflection()->MutableUnknownFields(job)->AddVarint(4000, 7);
    }
    return envelope.SerializeAsString();
  };
  FakePeer client(context, coordinator.endpoint());
  client.SendBytes(as_later({}, false));
  const v1::Error unknown = client.Receive().error();
  EXPECT_EQ(unknown.code(), v1::CODE_INVALID_ARGUMENT);
  EXPECT_EQ(unknown.message(), "a message that this end, of protocol 9.0, does not know; the peer has protocol 9.1");
  client.SendBytes(as_later(SubmitRequest(2, "/out/a"), true));
  EXPECT_TRUE(client.Receive().has_job_accepted());
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1");
  worker.Hello();
  EXPECT_TRUE(worker.peer.Await(v1::Envelope::kWorkerWelcome).has_worker_welcome());
  worker.peer.SendBytes(as_later({}, false));
  EXPECT_EQ(worker.peer.Await(v1::Envelope::kError).error().code(), v1::CODE_INVALID_ARGUMENT);
  worker.Ask();
  EXPECT_GT(worker.WorkUntilJobEnds(), 0) << "it is on the farm all the same";
}

// A worker of the minor version before: it tells no process, knows nothing of tasks to be given back.
TEST(Coordinator, AWorkerOfTheMinorVersionBeforeDoesItsTasks) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakePeer client(context, coordinator.endpoint());
  const auto job = client.Call(SubmitRequest(2, "/out/a")).job_accepted().job_id();
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1");
  worker.peer.minor = 0;
  worker.Hello();
  EXPECT_TRUE(worker.peer.Await(v1::Envelope::kWorkerWelcome).has_worker_welcome());
  worker.Ask();
  EXPECT_GT(worker.WorkUntilJobEnds(), 0);
  EXPECT_EQ(client.Call(StatusRequest(job)).job_status().state(), v1::JOB_STATE_DONE);
}

TEST(Coordinator, AWorkerThatReconnectsGoesOnUnderItsName) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakeFarmWorker before(context, coordinator.endpoint(), "w1");
  before.Hello();
  const auto id = before.peer.Await(v1::Envelope::kWorkerWelcome).worker_welcome().worker_id();
  FakeFarmWorker after(context, coordinator.endpoint(), "w1");
  after.Hello();
  EXPECT_EQ(after.peer.Await(v1::Envelope::kWorkerWelcome).worker_welcome().worker_id(), id);
  before.Ask();
  EXPECT_EQ(before.peer.Receive().error().code(), v1::CODE_UNAVAILABLE);
}

TEST(Coordinator, HeartbeatsAreAnsweredAndNameWhatIsNotTheWorkers) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1");
  worker.Hello();
  (void)worker.peer.Await(v1::Envelope::kWorkerWelcome);
  v1::Envelope beat;
  beat.mutable_heartbeat()->set_heartbeat_id(5);
  beat.mutable_heartbeat()->add_running_leases(123);
  const v1::Envelope ack = worker.peer.Call(beat);
  EXPECT_EQ(ack.heartbeat_ack().heartbeat_id(), 5U);
  ASSERT_EQ(ack.heartbeat_ack().unknown_leases_size(), 1);
  EXPECT_EQ(ack.heartbeat_ack().unknown_leases(0), 123U);
}

TEST(Coordinator, StopsOnRequestAndTellsItsWorkers) {
  const TemporaryFolder folder;
  RunningCoordinator coordinator(On(folder));
  TransportContext context;
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1");
  worker.Hello();
  (void)worker.peer.Await(v1::Envelope::kWorkerWelcome);
  FakePeer client(context, coordinator.endpoint());
  v1::Envelope stop;
  stop.mutable_stop_coordinator();
  EXPECT_TRUE(client.Call(stop).has_done());
  EXPECT_TRUE(worker.peer.Receive().has_stop_worker());
  coordinator.Join();
}

TEST(Coordinator, KeysHaveRoles) {
  const TemporaryFolder folder;
  const std::string keys = folder.File("keys");
  ASSERT_TRUE(CreateFarmKeys(keys).ok());
  RunningCoordinator coordinator({.endpoint = "tcp://127.0.0.1:*", .keys_dir = keys});
  TransportContext context;
  const WorkerKeys worker_keys = ReadWorkerKeys(keys).value();
  const ClientKeys client_keys = ReadClientKeys(keys).value();
  const ClientOptions as_worker = {.curve_server_public_key = worker_keys.coordinator_public_key,
                                   .curve_own = worker_keys.own};
  const ClientOptions as_client = {.curve_server_public_key = client_keys.coordinator_public_key,
                                   .curve_own = client_keys.own};
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1", as_worker);
  worker.Hello();
  EXPECT_TRUE(worker.peer.Receive().has_worker_welcome());
  EXPECT_NE(worker.peer.Call(StatusRequest(1)).error().message().find("role work may not send get_job_status"),
            std::string::npos);
  FakeFarmWorker impostor(context, coordinator.endpoint(), "w2", as_client);
  impostor.Hello();
  EXPECT_NE(impostor.peer.Receive().error().message().find("role admin may not send worker_hello"), std::string::npos);
  FakePeer client(context, coordinator.endpoint(), as_client);
  EXPECT_TRUE(client.Call(SubmitRequest(2, "/out/a")).has_job_accepted());
}

TEST(Coordinator, AKeyThatIsTakenOffTheListEndsItsWorkersAndNobodyElses) {
  const TemporaryFolder folder;
  const std::string keys = folder.File("keys");
  ASSERT_TRUE(CreateFarmKeys(keys).ok());
  const WorkerKeys worker_keys = ReadWorkerKeys(keys).value();
  const ClientKeys client_keys = ReadClientKeys(keys).value();
  const CurveKeys other = GenerateCurveKeys().value();
  // Two keys of one name, as in the middle of a rotation.
  const std::string lines = "work " + other.public_key + " worker\nadmin " + client_keys.own.public_key + " client\n";
  const std::string authorized = keys + "/authorized";
  std::ofstream(authorized, std::ios::app) << "work " << other.public_key << " worker\n";
  RunningCoordinator coordinator({.endpoint = "tcp://127.0.0.1:*", .keys_dir = keys});
  TransportContext context;
  const auto as = [&](const CurveKeys& own) {
    return ClientOptions{.curve_server_public_key = worker_keys.coordinator_public_key, .curve_own = own};
  };
  FakePeer client(context, coordinator.endpoint(), as(client_keys.own));
  ASSERT_TRUE(client.Call(SubmitRequest(2, "/out/a")).has_job_accepted());
  FakeFarmWorker removed(context, coordinator.endpoint(), "removed", as(worker_keys.own));
  removed.Hello();
  ASSERT_TRUE(removed.peer.Receive().has_worker_welcome());
  removed.Ask();
  ASSERT_TRUE(removed.peer.Receive().has_grant_task());
  FakeFarmWorker stays(context, coordinator.endpoint(), "stays", as(other));
  stays.Hello();
  ASSERT_TRUE(stays.peer.Receive().has_worker_welcome());

  // A broken list changes nothing.
  std::ofstream(authorized) << "work not-a-key\n";
  coordinator.RereadKeys();
  v1::Envelope list;
  list.mutable_list_workers();
  EXPECT_EQ(client.Call(list).worker_list().workers_size(), 2);

  std::ofstream(authorized) << lines;
  coordinator.RereadKeys();
  EXPECT_NE(removed.peer.Receive().error().message().find("taken off"), std::string::npos);
  EXPECT_TRUE(removed.peer.Receive().has_stop_worker());
  const v1::Envelope left = client.Call(list);
  ASSERT_EQ(left.worker_list().workers_size(), 1);
  EXPECT_EQ(left.worker_list().workers(0).name(), "stays");
  // Its task is another one's now, and it gets nothing more: neither a welcome nor an answer.
  stays.Ask();
  EXPECT_TRUE(stays.peer.Receive().has_grant_task());
  removed.Hello();
  EXPECT_EQ(client.Call(list).worker_list().workers_size(), 1);
  EXPECT_EQ(removed.peer.TryReceive(), std::nullopt);
}

TEST(Coordinator, CountsWhatItDoesNotTake) {
  Coordinator coordinator({}, 1, Journal::Open("", {}).value(), true);
  const auto handle = [&](const std::string& user, const std::string& payload) {
    coordinator.Handle({"peer", user, payload, "key"}, {});
  };
  v1::Envelope list;
  list.mutable_list_workers();
  handle("submit:anna", SerializeEnvelope(list));
  EXPECT_EQ(coordinator.refusals().total(), 0U);
  handle("work:w", SerializeEnvelope(list));
  EXPECT_EQ(coordinator.refusals().wrong_role, 1U);
  EXPECT_EQ(coordinator.refusals().last_user, "work:w");
  handle("submit:anna", "no envelope");
  EXPECT_EQ(coordinator.refusals().malformed, 1U);
  v1::Envelope old = list;
  old.set_protocol_version(1);
  handle("submit:anna", old.SerializeAsString());
  EXPECT_EQ(coordinator.refusals().other_version, 1U);
  EXPECT_EQ(coordinator.refusals().total(), 3U);
}

TEST(CoordinatorOptions, NameTheValueAndTheBound) {
  const auto message = [](const CoordinatorOptions& options) {
    return CoordinatorServer::Create(options).status().message();
  };
  EXPECT_NE(message({.endpoint = "tcp://127.0.0.1:*"}).find("needs keys"), std::string::npos);
  EXPECT_NE(message({.endpoint = "tcp://*:*", .insecure = true}).find("not a loopback"), std::string::npos);
  EXPECT_NE(message({.heartbeat = std::chrono::milliseconds(3000)}).find("9000"), std::string::npos);
  EXPECT_NE(message({.max_attempts = 0}).find("expected 1 to 100"), std::string::npos);
  EXPECT_NE(message({.endpoint = "tcp://127.0.0.1:*", .keys_dir = "/nowhere"}).find("/nowhere"), std::string::npos);
}

TEST(Coordinator, TellsWhereTheResultsOfAJobAre) {
  const TemporaryFolder folder;
  CoordinatorOptions options = On(folder);
  options.kept_jobs = 2;
  RunningCoordinator coordinator(options);
  TransportContext context;
  FakePeer client(context, coordinator.endpoint());
  FakeFarmWorker worker(context, coordinator.endpoint(), "w1");
  worker.Hello();
  worker.Ask();
  v1::Envelope submit = SubmitRequest(4, "");
  submit.mutable_submit_job()->set_keeps_results(true);
  ASSERT_EQ(client.Call(submit).job_accepted().job_id(), 1U);
  EXPECT_EQ(worker.WorkUntilJobEnds(), 4 * 13);
  EXPECT_TRUE(client.Call(StatusRequest(1)).job_status().keeps_results());

  v1::Envelope request;
  request.mutable_get_results()->set_job_id(1);
  const v1::Envelope answer = client.Call(request);
  const v1::Results& results = answer.results();
  EXPECT_EQ(results.state(), v1::JOB_STATE_DONE);
  EXPECT_TRUE(results.job().keeps_results());
  EXPECT_EQ(results.num_frames(), 4U);
  EXPECT_EQ(results.next_frame(), 4U);
  ASSERT_EQ(results.frames_size(), 4);
  EXPECT_EQ(results.frames(2).frame(), 2U);
  EXPECT_EQ(results.frames(2).files_size(), 3);
  EXPECT_EQ(results.frames(2).picture_digests_size(), 3);
  ASSERT_EQ(results.frames(2).locations_size(), 1);
  EXPECT_EQ(results.frames(2).locations(0).endpoint(), "ipc:///nowhere/w1");
  request.mutable_get_results()->set_first_frame(3);
  const v1::Envelope rest = client.Call(request);
  EXPECT_EQ(rest.results().frames_size(), 1);
  EXPECT_FALSE(rest.results().has_job());
  request.mutable_get_results()->set_first_frame(4'000'000'000U);
  EXPECT_EQ(client.Call(request).results().frames_size(), 0);

  for (const char* dir : {"/out/a", "/out/b"}) {
    ASSERT_TRUE(client.Call(SubmitRequest(1, dir)).has_job_accepted());
    (void)worker.WorkUntilJobEnds();
  }
  request.mutable_get_results()->set_job_id(2);
  EXPECT_NE(client.Call(request).error().message().find("writes to /out/a"), std::string::npos);
  request.mutable_get_results()->set_job_id(1);  // forgotten: two jobs have ended since
  EXPECT_EQ(client.Call(request).error().message(), "there is no job 1");
  const v1::Envelope release = worker.peer.Await(v1::Envelope::kReleaseArtifacts);
  EXPECT_GT(release.release_artifacts().keys_size(), 0);
}

}  // namespace
}  // namespace depthfarm
