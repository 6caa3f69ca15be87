#include "coordinator/scheduling/analysis_memo.h"

#include <gtest/gtest.h>

#include "common/digest/sha256.h"

namespace depthfarm {
namespace {

TEST(AnalysisMemo, RemembersTheLastOfARequest) {
  AnalysisMemo memo(2);
  EXPECT_FALSE(memo.Find(Sha256("a")).has_value());
  memo.Remember(Sha256("a"), Sha256("1"));
  memo.Remember(Sha256("a"), Sha256("2"));
  EXPECT_EQ(memo.Find(Sha256("a")), Sha256("2"));
  memo.Remember(Sha256("b"), Sha256("3"));
  EXPECT_TRUE(memo.Find(Sha256("a")).has_value()) << "it has one place";
}

TEST(AnalysisMemo, ForgetsTheOldestBeyondItsBound) {
  AnalysisMemo memo(2);
  for (const char* request : {"a", "b", "c"}) memo.Remember(Sha256(request), Sha256("made"));
  EXPECT_FALSE(memo.Find(Sha256("a")).has_value());
  EXPECT_TRUE(memo.Find(Sha256("b")).has_value());
  EXPECT_TRUE(memo.Find(Sha256("c")).has_value());
}

}  // namespace
}  // namespace depthfarm
