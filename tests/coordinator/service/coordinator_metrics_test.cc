#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

#include "coordinator/service/coordinator_server.h"
#include "tests/coordinator/service/fake_peers.h"
#include "tests/support/temporary_folder.h"

// After Eigen, which macros of the resolver, included here, would break.
#include <httplib.h>

namespace depthfarm {
namespace {

using testing::HasSubstr;
using testing_support::TemporaryFolder;

TEST(Coordinator, TellsWhatHappenedInNumbers) {
  const TemporaryFolder folder;
  CoordinatorOptions options;
  options.metrics = "127.0.0.1:*";
  options.version = "1.2.3";
  options.endpoint = "ipc://" + folder.File("coordinator");
  const auto coordinator = CoordinatorServer::Create(options);
  ASSERT_TRUE(coordinator.ok()) << coordinator.status().message();
  std::thread thread([&] { EXPECT_TRUE((*coordinator)->Run().ok()); });
  TransportContext context;
  FakePeer client(context, (*coordinator)->endpoint());
  FakeFarmWorker worker(context, (*coordinator)->endpoint(), "w1");
  worker.Hello();
  (void)worker.peer.Await(v1::Envelope::kWorkerWelcome);
  ASSERT_TRUE(client.Call(SubmitRequest(2, "/out/a")).has_job_accepted());
  worker.Ask();
  const v1::Envelope grant = worker.peer.Await(v1::Envelope::kGrantTask);
  worker.Report(grant.grant_task());
  httplib::Client http("http://" + (*coordinator)->metrics_address());
  std::string text;
  for (int i = 0; i < 600 && text.find("outcome=\"done\"} 1") == std::string::npos; ++i) {
    if (const auto answer = http.Get("/metrics")) text = answer->body;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_THAT(text, HasSubstr("depthfarm_info{version=\"1.2.3\""));
  EXPECT_THAT(text, HasSubstr("depthfarm_workers 1\n"));
  EXPECT_THAT(text, HasSubstr("depthfarm_jobs_running 1\n"));
  EXPECT_THAT(text, HasSubstr("depthfarm_attempts_total{kind=\"prepare\",outcome=\"done\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("depthfarm_task_cpu_seconds_total{kind=\"prepare\"} 0.5\n"));
  EXPECT_EQ(http.Get("/healthz")->status, 200);
  (*coordinator)->Stop();
  thread.join();
}

}  // namespace
}  // namespace depthfarm
