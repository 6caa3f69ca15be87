#include "coordinator/service/worker_sessions.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

WorkerSession Hello(const std::string& peer, const std::string& name, const std::string& user = "work:a") {
  return {WorkerId(), peer, "key of " + user, user, name, "1", {}};
}

TEST(WorkerSessions, ANameKeepsItsIdUnderANewPeer) {
  WorkerSessions sessions;
  const WorkerId id = sessions.Join(Hello("p1", "w")).value();
  EXPECT_EQ(sessions.Join(Hello("p2", "w")).value(), id);
  EXPECT_EQ(sessions.FindPeer("p1"), nullptr);
  EXPECT_EQ(sessions.FindPeer("p2")->id, id);
  EXPECT_EQ(sessions.all().size(), 1U);
}

TEST(WorkerSessions, ANameOfAnotherUserIsRefused) {
  WorkerSessions sessions;
  ASSERT_TRUE(sessions.Join(Hello("p1", "w")).ok());
  EXPECT_EQ(sessions.Join(Hello("p2", "w", "work:b")).status().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(sessions.FindPeer("p1")->peer, "p1");
}

TEST(WorkerSessions, APeerIsOneWorker) {
  WorkerSessions sessions;
  const WorkerId first = sessions.Join(Hello("p1", "w1")).value();
  const WorkerId second = sessions.Join(Hello("p1", "w2")).value();
  EXPECT_NE(first, second);
  EXPECT_EQ(sessions.Find(first), nullptr);
}

TEST(WorkerSessions, AKeyThatGotAnotherUserKeepsItsWorkers) {
  WorkerSessions sessions;
  const WorkerId id = sessions.Join(Hello("p1", "w")).value();
  sessions.SetUser(id, "work:b");
  EXPECT_EQ(sessions.Join(Hello("p2", "w", "work:b")).value(), id);
}

TEST(WorkerSessions, WhoLeftIsForgottenEverywhere) {
  WorkerSessions sessions;
  const WorkerId id = sessions.Join(Hello("p1", "w")).value();
  sessions.Remove(id);
  sessions.Remove(id);
  EXPECT_EQ(sessions.FindPeer("p1"), nullptr);
  EXPECT_NE(sessions.Join(Hello("p1", "w")).value(), id);
}

}  // namespace
}  // namespace depthfarm
