#include "worker/service/computing_leases.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ComputingLeases, AreThoseOfTheProcessThatIsGone) {
  const auto leases = ComputingLeases::Make(3).value();
  EXPECT_THAT(leases->List(), IsEmpty());
  const pid_t worker = ::fork();
  if (worker == 0) {
    leases->Begin(0, LeaseId(5));
    leases->Begin(1, LeaseId(6));
    leases->Begin(2, LeaseId(7));
    leases->End(1);
    (void)std::raise(SIGKILL);
    ::_exit(0);
  }
  ASSERT_EQ(::waitpid(worker, nullptr, 0), worker);
  EXPECT_THAT(leases->List(), ElementsAre(LeaseId(5), LeaseId(7)));
}

}  // namespace
}  // namespace depthfarm
