#include "coordinator/scheduling/kept_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

ArtifactKey Key(std::uint8_t number) { return {number}; }

JobResults ResultsOf(const std::vector<std::uint8_t>& bundles) {
  JobResults results;
  for (const std::uint8_t number : bundles) {
    results.frames.push_back({.files = {{}, {}}, .bundle = ArtifactInfo{Key(number), 1, {}}});
  }
  results.frames.push_back({});  // not done
  return results;
}

TEST(KeptResults, AreWantedAsLongAsAJobHasThem) {
  KeptResults kept;
  EXPECT_THAT(kept.Add(JobId(1), ResultsOf({1, 2})), IsEmpty());
  EXPECT_THAT(kept.Add(JobId(2), ResultsOf({2, 3})), IsEmpty());
  EXPECT_EQ(kept.Find(JobId(1))->frames.size(), 3U);
  EXPECT_EQ(kept.Find(JobId(3)), nullptr);
  EXPECT_TRUE(kept.Wants(Key(2)));
  EXPECT_THAT(kept.Forget(JobId(1)), ElementsAre(Key(1)));
  EXPECT_THAT(kept.Forget(JobId(1)), IsEmpty());
  EXPECT_FALSE(kept.Wants(Key(1)));
  EXPECT_THAT(kept.Forget(JobId(2)), ElementsAre(Key(2), Key(3)));
}

TEST(KeptResults, OfTheOldestJobsAreForgottenBeyondTheBound) {
  KeptResults kept(5);
  (void)kept.Add(JobId(1), ResultsOf({1}));
  (void)kept.Add(JobId(2), ResultsOf({2}));
  EXPECT_THAT(kept.Add(JobId(3), ResultsOf({1})), IsEmpty()) << "the bundle of job 1 is job 3's too";
  EXPECT_EQ(kept.Find(JobId(1)), nullptr);
  EXPECT_THAT(kept.Add(JobId(4), ResultsOf({4})), ElementsAre(Key(2)));
  EXPECT_NE(kept.Find(JobId(3)), nullptr);
}

}  // namespace
}  // namespace depthfarm
