// Tasks that find what they would make.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/digest/sha256.h"
#include "tests/worker/execution/small_job.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

TEST(ReusedTask, ARepeatedJobReusesWhatExists) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(job.RunOn({&worker}).ok());
  for (const TaskSpec& spec :
       {job.Analyse(0, 1), job.Estimate(1, 0), job.Merge(1), job.Refine(1, 0, 2), job.Refine(1, 2, 1)}) {
    const TaskOutcome outcome = worker.Execute(spec, job.config);
    ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
    EXPECT_TRUE(outcome.stats.reused) << TaskName(spec.id);
    EXPECT_EQ(outcome.artifact, worker.store->Find(outcome.artifact->key));
  }
}

TEST(ReusedTask, AnAnalysisThatAnotherWorkerHoldsIsFetchedNotMade) {
  SmallJob job;
  TestWorker first;
  TestWorker second;
  const TaskOutcome made = first.Execute(job.Analyse(0, 0), job.config);
  second.fetcher.stores = {first.store.get()};
  TaskSpec spec = job.Analyse(0, 0);
  spec.known = TaskInput{*made.artifact, InputRole::kAnalysis, 0, {}};
  const TaskOutcome outcome = second.Execute(spec, job.config);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
  EXPECT_TRUE(outcome.stats.reused);
  EXPECT_EQ(outcome.artifact, made.artifact);
  EXPECT_EQ(outcome.picture_digest, made.picture_digest);
  EXPECT_GT(outcome.stats.fetched_bytes, 0U);
}

TEST(ReusedTask, AnAnalysisOfAPictureThatChangedIsMadeWhateverTheCoordinatorBelieves) {
  SmallJob job;
  TestWorker first;
  TestWorker second;
  const TaskOutcome made = first.Execute(job.Analyse(0, 0), job.config);
  second.fetcher.stores = {first.store.get()};
  TaskSpec spec = job.Analyse(0, 1);  // as if this were what the file holds now
  spec.known = TaskInput{*made.artifact, InputRole::kAnalysis, 0, {}};
  const TaskOutcome outcome = second.Execute(spec, job.config);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
  EXPECT_FALSE(outcome.stats.reused);
  EXPECT_NE(outcome.artifact->key, made.artifact->key);
  EXPECT_EQ(second.fetcher.fetches, 0);
}

TEST(ReusedTask, AnAnalysisThatCannotBeFetchedIsMade) {
  SmallJob job;
  TestWorker first;
  TestWorker second;
  const TaskOutcome made = first.Execute(job.Analyse(0, 0), job.config);
  TaskSpec spec = job.Analyse(0, 0);
  spec.known = TaskInput{*made.artifact, InputRole::kAnalysis, 0, {}};
  const TaskOutcome outcome = second.Execute(spec, job.config);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
  EXPECT_FALSE(outcome.stats.reused);
  EXPECT_EQ(outcome.artifact, made.artifact);
  EXPECT_TRUE(outcome.missing_inputs.empty());
}

TEST(ReusedTask, ADamagedArtifactIsMadeAgainNotReused) {
  SmallJob job;
  TestWorker worker;
  const TaskOutcome first = worker.Execute(job.Analyse(0, 0), job.config);
  ASSERT_TRUE(worker.store->Put(*first.output_key, "rubbish").ok());
  worker.cache.Erase(*first.output_key);
  const TaskOutcome second = worker.Execute(job.Analyse(0, 0), job.config);
  ASSERT_TRUE(second.status.ok()) << second.status.message();
  EXPECT_FALSE(second.stats.reused);
  EXPECT_EQ(second.artifact, first.artifact);
}

// A byte of the file of an artifact, in its place.
void Damage(const TestWorker& worker, const ArtifactKey& key) {
  for (const auto& entry : fs::recursive_directory_iterator(worker.folder.path())) {
    if (entry.path().filename() != Hex(key)) continue;
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-1, std::ios::end).put('\x5a');
    ASSERT_TRUE(file.flush());
  }
}

TEST(ReusedTask, WhatIsInMemoryDoesNotStandInForADamagedFile) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(job.RunOn({&worker}).ok());
  for (const TaskSpec& spec : {job.Analyse(0, 1), job.Estimate(1, 0), job.Refine(1, 0, 2)}) {
    const ArtifactInfo made = *worker.Execute(spec, job.config).artifact;
    Damage(worker, made.key);
    const TaskOutcome again = worker.Execute(spec, job.config);
    ASSERT_TRUE(again.status.ok()) << again.status.message();
    EXPECT_FALSE(again.stats.reused) << TaskName(spec.id);
    EXPECT_EQ(again.artifact, made);
    EXPECT_TRUE(worker.store->Get(made.key).ok()) << "what others are given";
  }
}

TEST(ReusedTask, BlocksOfAFrameShareItsAnalysis) {
  SmallJob job;
  TestWorker holder;
  ASSERT_TRUE(AnalyseFirstFrame(job, holder).ok());
  TestWorker worker;
  worker.fetcher.stores = {holder.store.get()};
  const TaskOutcome first = worker.Execute(job.Estimate(0, 0), job.config);
  ASSERT_TRUE(first.status.ok()) << first.status.message();
  EXPECT_EQ(worker.fetcher.fetches, 3);
  EXPECT_GT(first.stats.fetched_bytes, 0);
  const TaskOutcome second = worker.Execute(job.Estimate(0, 1), job.config);
  ASSERT_TRUE(second.status.ok());
  EXPECT_EQ(worker.fetcher.fetches, 3);
  EXPECT_EQ(second.stats.fetched_bytes, 0);
}

TEST(ReusedTask, UsesTheBytesTheJobNamesNotOthersOfTheSameKey) {
  SmallJob job;
  TestWorker holder;
  ASSERT_TRUE(AnalyseFirstFrame(job, holder).ok());
  const TaskSpec spec = job.Estimate(0, 0);
  TestWorker worker;
  worker.fetcher.stores = {holder.store.get()};
  const std::string other_view = holder.store->Get(spec.inputs[1].artifact.key).value();
  ASSERT_TRUE(worker.store->Put(spec.inputs[0].artifact.key, other_view).ok());
  const TaskOutcome outcome = worker.Execute(spec, job.config);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
  EXPECT_EQ(outcome.artifact, holder.Execute(spec, job.config).artifact);
}

}  // namespace
}  // namespace depthfarm
