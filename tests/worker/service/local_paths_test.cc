#include "worker/service/local_paths.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

PathMap TestMap() { return PathMap::Parse({"/shared=/mnt/nas", "/shared/out=/scratch"}).value(); }

TEST(LocalPaths, AreThoseOfEveryFileThatATaskReads) {
  TaskSpec spec;
  spec.picture = "/shared/cam0/0000.png";
  spec.guides = {.mask = "/shared/m.png", .prior = "/shared/p.pfm", .prior_confidence = "/shared/c.png"};
  spec.staging = "f0-a1-l1";
  spec.files = {{.path = "depth/cam0/0000.png", .sha256 = {}, .bytes = 1}};
  TaskSpec expected = spec;
  expected.picture = "/mnt/nas/cam0/0000.png";
  expected.guides = {.mask = "/mnt/nas/m.png", .prior = "/mnt/nas/p.pfm", .prior_confidence = "/mnt/nas/c.png"};
  EXPECT_EQ(WithLocalPaths(spec, TestMap()), expected);
  EXPECT_EQ(WithLocalPaths(spec, PathMap()), spec);
}

TEST(LocalPaths, AreThoseOfTheFoldersOfAJob) {
  JobConfig config;
  config.output_dir = "/shared/out/studio";
  config.sequence_file = "/shared/studio/sequence.json";
  config.render = RenderSource{.depth_dir = "/shared/depth", .manifest_sha256 = {}};
  const JobConfig here = WithLocalPaths(config, TestMap());
  EXPECT_EQ(here.output_dir, "/scratch/studio");
  EXPECT_EQ(here.sequence_file, "/mnt/nas/studio/sequence.json");
  EXPECT_EQ(here.render->depth_dir, "/mnt/nas/depth");
}

}  // namespace
}  // namespace depthfarm
