#include "common/base/shared_bytes.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

TEST(SharedBytes, AreThoseOfTheStringWhereverTheyGo) {
  for (const std::string& bytes : {std::string(), std::string("few"), std::string(1000, 'x')}) {
    SharedBytes shared(bytes);
    const SharedBytes copy = shared;
    const SharedBytes moved = std::move(shared);
    EXPECT_EQ(copy.view(), bytes);
    EXPECT_EQ(moved.view().data(), copy.view().data());
    EXPECT_EQ(moved.size(), bytes.size());
    EXPECT_EQ(moved.empty(), bytes.empty());
  }
}

TEST(SharedBytes, HoldTheirOwnerUntilTheLastCopyGoes) {
  auto owner = std::make_shared<const std::string>("owned");
  const std::weak_ptr<const std::string> seen = owner;
  {
    const SharedBytes shared(*owner, owner);
    owner.reset();
    {
      const SharedBytes copy = shared;
      EXPECT_EQ(copy.view(), "owned");
    }
    EXPECT_FALSE(seen.expired());
  }
  EXPECT_TRUE(seen.expired());
}

}  // namespace
}  // namespace depthfarm
