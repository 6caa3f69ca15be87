#include "coordinator/scheduling/artifact_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using AddResult = ArtifactDirectory::AddResult;

ArtifactInfo Artifact(std::uint8_t key, std::uint8_t content, std::uint64_t bytes = 10) {
  return {ArtifactKey{key}, bytes, ContentDigest{content}};
}

TEST(ArtifactDirectory, RemembersWhoHoldsWhat) {
  ArtifactDirectory directory;
  EXPECT_EQ(directory.Add(WorkerId(1), Artifact(1, 1)), AddResult::kAdded);
  EXPECT_EQ(directory.Add(WorkerId(2), Artifact(1, 1)), AddResult::kAdded);
  EXPECT_EQ(directory.Add(WorkerId(2), Artifact(1, 1)), AddResult::kAdded);
  EXPECT_THAT(directory.Holders(ArtifactKey{1}), testing::ElementsAre(WorkerId(1), WorkerId(2)));
  EXPECT_EQ(directory.Bytes(WorkerId(2)), 10U);
  EXPECT_EQ(directory.Count(WorkerId(2)), 1U);
}

TEST(ArtifactDirectory, AnotherContentUnderTheSameKeyIsAConflictAndTheFirstStays) {
  ArtifactDirectory directory;
  EXPECT_EQ(directory.Add(WorkerId(1), Artifact(1, 1)), AddResult::kAdded);
  EXPECT_EQ(directory.Add(WorkerId(2), Artifact(1, 2)), AddResult::kConflict);
  EXPECT_EQ(directory.Find(ArtifactKey{1})->content_digest, ContentDigest{1});
  EXPECT_FALSE(directory.Holds(WorkerId(2), ArtifactKey{1}));
}

TEST(ArtifactDirectory, ReportsTheLastHolderOnly) {
  ArtifactDirectory directory;
  (void)directory.Add(WorkerId(1), Artifact(1, 1));
  (void)directory.Add(WorkerId(2), Artifact(1, 1));
  (void)directory.Add(WorkerId(1), Artifact(2, 1));
  EXPECT_THAT(directory.RemoveWorker(WorkerId(1)), testing::ElementsAre(ArtifactKey{2}));
  EXPECT_TRUE(directory.Remove(WorkerId(2), ArtifactKey{1}));
  EXPECT_FALSE(directory.Remove(WorkerId(2), ArtifactKey{1}));
  EXPECT_TRUE(directory.empty());
  EXPECT_EQ(directory.Bytes(WorkerId(1)), 0U);
}

}  // namespace
}  // namespace depthfarm
