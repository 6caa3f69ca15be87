#include "coordinator/metrics/metrics_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

namespace depthfarm {
namespace {

using testing::HasSubstr;
using SteadyClock = std::chrono::steady_clock;

TEST(MetricsServer, ServesWhatWasPublishedLast) {
  const auto server = MetricsServer::Start("127.0.0.1:*");
  ASSERT_TRUE(server.ok()) << server.status().message();
  httplib::Client client("http://" + (*server)->address());
  (*server)->Publish("one 1\n", SteadyClock::now());
  EXPECT_EQ(client.Get("/metrics")->body, "one 1\n");
  (*server)->Publish("one 2\n", SteadyClock::now());
  const auto second = client.Get("/metrics");
  ASSERT_TRUE(second);
  EXPECT_EQ(second->body, "one 2\n");
  EXPECT_EQ(second->get_header_value("Content-Type"), "text/plain; version=0.0.4");
  EXPECT_EQ(client.Get("/")->status, 404);
  EXPECT_EQ(client.Get("/../etc/passwd")->status, 404);
  EXPECT_EQ(client.Post("/metrics", "x", "text/plain")->status, 404);
}

TEST(MetricsServer, IsHealthyAsLongAsSomebodyPublishes) {
  const auto server = MetricsServer::Start("127.0.0.1:*");
  ASSERT_TRUE(server.ok());
  httplib::Client client("http://" + (*server)->address());
  EXPECT_EQ(client.Get("/healthz")->status, 200);
  (*server)->Publish("", SteadyClock::now() - MetricsServer::kHealthy - std::chrono::seconds(1));
  EXPECT_EQ(client.Get("/healthz")->status, 503);
  (*server)->Publish("", SteadyClock::now());
  EXPECT_EQ(client.Get("/healthz")->body, "ok\n");
}

TEST(MetricsServer, SaysWhereItCannotBe) {
  for (const char* wrong : {"", "127.0.0.1", ":9470", "127.0.0.1:0", "127.0.0.1:65536", "127.0.0.1:x", "127.0.0.1:"}) {
    EXPECT_EQ(MetricsServer::Start(wrong).status().code(), ErrorCode::kInvalidArgument) << wrong;
  }
  const auto first = MetricsServer::Start("127.0.0.1:*");
  ASSERT_TRUE(first.ok());
  const auto second = MetricsServer::Start((*first)->address());
  EXPECT_EQ(second.status().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(second.status().message(), HasSubstr((*first)->address()));
}

}  // namespace
}  // namespace depthfarm
