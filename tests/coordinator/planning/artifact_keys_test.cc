#include "coordinator/planning/artifact_keys.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <vector>

#include "tests/coordinator/planned_job.h"

namespace depthfarm {
namespace {

using Inputs = std::vector<ArtifactKeys::Input>;

Inputs TwoInputs() { return {{InputRole::kAnalysis, ArtifactKey{1}}, {InputRole::kAnalysis, ArtifactKey{2}}}; }

ArtifactKey KeyOf(const JobConfig& config) { return ArtifactKeys(config).Estimate(4, 1, TwoInputs()); }

TEST(ArtifactKeys, WhatReachesTheEnergyChangesTheKey) {
  using Change = std::function<void(JobConfig&)>;
  const std::vector<Change> changes = {
      [](JobConfig& c) { ++c.algorithm_version; },
      [](JobConfig& c) { ++c.resolved.params.levels; },
      [](JobConfig& c) { c.resolved.params.z_near *= 1.0000001; },
      [](JobConfig& c) { c.resolved.params.z_far *= 1.0000001; },
      [](JobConfig& c) { c.resolved.params.smoothing += 0.5; },
      [](JobConfig& c) { c.resolved.params.matching_window += 2; },
      [](JobConfig& c) { c.resolved.params.matching_offset += 1; },
      [](JobConfig& c) { --c.resolved.params.uniqueness; },
      [](JobConfig& c) { ++c.resolved.params.p_threshold; },
      [](JobConfig& c) { ++c.resolved.params.i_threshold; },
      [](JobConfig& c) { ++c.resolved.params.max_sweeps; },
      [](JobConfig& c) { c.resolved.params.search = Search::kFull; },
      [](JobConfig& c) { c.resolved.params.partition = Partition::kContiguous; },
      [](JobConfig& c) { c.resolved.reference.cam_from_world_translation[0] = 1; },
      [](JobConfig& c) { c.resolved.views[1].camera.intrinsics(0, 2) = 3; },
      [](JobConfig& c) { c.resolved.views[1].camera.width = 17; },
      [](JobConfig& c) { c.resolved.views[1].neighbours.clear(); },
  };
  const JobConfig base = MakePlannedJob({}).config;
  std::set<ArtifactKey> keys = {KeyOf(base)};
  for (const Change& change : changes) {
    JobConfig changed = base;
    change(changed);
    keys.insert(KeyOf(changed));
  }
  EXPECT_EQ(keys.size(), changes.size() + 1);
}

TEST(ArtifactKeys, WhatReachesTheRefinementOnlyChangesItsKeyOnly) {
  using Change = std::function<void(JobConfig&)>;
  const std::vector<Change> changes = {
      [](JobConfig& c) { ++c.resolved.params.refine_rounds; },
      [](JobConfig& c) { ++c.resolved.params.choice_rounds; },
      [](JobConfig& c) { c.resolved.views[1].compared.clear(); },
      [](JobConfig& c) { c.resolved.views[1].own_range.z_near += 1e-9; },
  };
  const auto refine_key = [](const JobConfig& config) { return ArtifactKeys(config).Refine(1, 0, TwoInputs()); };
  const JobConfig base = MakePlannedJob({.refine = 4}).config;
  std::set<ArtifactKey> keys = {refine_key(base)};
  for (const Change& change : changes) {
    JobConfig changed = base;
    change(changed);
    keys.insert(refine_key(changed));
    EXPECT_EQ(KeyOf(changed), KeyOf(base));
  }
  JobConfig energy = base;
  energy.resolved.params.smoothing += 1;
  keys.insert(refine_key(energy));
  EXPECT_EQ(keys.size(), changes.size() + 2);
}

TEST(ArtifactKeys, RefinementThatLevelsAreSearchedForChangesTheKeyOfLabels) {
  JobConfig levels = MakePlannedJob({}).config;
  levels.resolved.params.levels = 250;
  JobConfig refined = levels;
  refined.resolved.params.refine_rounds = 4;
  ASSERT_NE(SearchStep(levels.resolved, 1), SearchStep(refined.resolved, 1));
  EXPECT_NE(KeyOf(levels), KeyOf(refined));
}

TEST(ArtifactKeys, WhatDoesNotReachTheEnergyDoesNot) {
  const JobConfig base = MakePlannedJob({}).config;
  JobConfig other = MakePlannedJob({.id = 9, .frames = 8, .gop = 4}).config;
  other.sequence_name = "other";
  other.output_dir = "/elsewhere";
  EXPECT_EQ(KeyOf(base), KeyOf(other));
}

TEST(ArtifactKeys, TaskAndInputsChangeTheKey) {
  const ArtifactKeys keys(MakePlannedJob({}).config);
  Inputs swapped = {TwoInputs()[1], TwoInputs()[0]};
  Inputs other_role = TwoInputs();
  other_role[1].role = InputRole::kLabels;
  const std::set<ArtifactKey> distinct = {keys.Estimate(4, 1, TwoInputs()), keys.Estimate(4, 2, TwoInputs()),
                                          keys.Estimate(5, 1, TwoInputs()), keys.Estimate(4, 1, swapped),
                                          keys.Estimate(4, 1, other_role),  keys.Estimate(4, 1, {}),
                                          keys.Merge(TwoInputs()),          keys.Merge(swapped),
                                          keys.Refine(1, 2, TwoInputs()),   keys.Refine(2, 1, TwoInputs()),
                                          keys.Refine(1, 1, TwoInputs()),   keys.Refine(1, 2, swapped)};
  EXPECT_EQ(distinct.size(), 12U);
}

TEST(ArtifactKeys, AnalysisOfAnIFrameDoesNotDependOnWhatStandsStill) {
  const JobConfig base = MakePlannedJob({}).config;
  JobConfig other = base;
  ++other.resolved.params.p_threshold;
  const auto request = [](const JobConfig& config, const Inputs& inputs) {
    return ArtifactKeys::AnalysisRequest(config, 0, "/in/cam0/0.png", {}, inputs);
  };
  const Inputs before = {{InputRole::kPreviousAnalysis, ArtifactKey{1}}};
  EXPECT_EQ(request(base, {}), request(other, {}));
  EXPECT_NE(request(base, before), request(other, before));
  EXPECT_NE(request(base, {}), request(base, before));
}

TEST(ArtifactKeys, OneBlockIsTheSameHoweverLevelsAreSpread) {
  JobConfig contiguous = MakePlannedJob({}).config;
  contiguous.resolved.params.partition = Partition::kContiguous;
  EXPECT_EQ(ArtifactKeys(contiguous).Estimate(1, 0, TwoInputs()),
            ArtifactKeys(MakePlannedJob({}).config).Estimate(1, 0, TwoInputs()));
}

}  // namespace
}  // namespace depthfarm
