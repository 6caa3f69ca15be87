#include "coordinator/scheduling/gop_homes.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

TEST(GopHomes, AGopStaysWithWhoeverClaimedItFirst) {
  GopHomes homes;
  EXPECT_FALSE(homes.HomeOf(0));
  homes.Claim(0, WorkerId(1));
  homes.Claim(0, WorkerId(2));
  homes.Claim(5, WorkerId(1));
  EXPECT_EQ(homes.HomeOf(0), WorkerId(1));
  EXPECT_EQ(homes.Of(WorkerId(1)), (std::vector<int>{0, 5}));
  EXPECT_TRUE(homes.Of(WorkerId(2)).empty());
}

TEST(GopHomes, GopsOfAWorkerThatIsGoneAreFree) {
  GopHomes homes;
  homes.Claim(0, WorkerId(1));
  homes.Claim(1, WorkerId(2));
  homes.Forget(WorkerId(1));
  homes.Claim(0, WorkerId(2));
  EXPECT_EQ(homes.Of(WorkerId(2)), (std::vector<int>{0, 1}));
  homes.End(1);
  EXPECT_FALSE(homes.HomeOf(1));
}

}  // namespace
}  // namespace depthfarm
