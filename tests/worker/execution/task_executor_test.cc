#include "worker/execution/task_executor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/files/file_bundle.h"
#include "common/media/depth_file.h"
#include "common/sequence/depth_manifest.h"
#include "tests/worker/execution/small_job.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::SizeIs;

// Relative path -> content of every file below a folder.
std::map<std::string, std::string> Contents(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    contents[fs::relative(entry.path(), folder).string()] =
        ReadFileBytes(entry.path().string(), std::uint64_t{1} << 30).value();
  }
  return contents;
}

TEST(TaskExecutor, RunsAWholeJob) {
  SmallJob job;
  TestWorker worker;
  const Status status = job.RunOn({&worker});
  ASSERT_TRUE(status.ok()) << status.message();

  const DepthManifest manifest = ReadDepthManifest(job.output().string()).value();
  EXPECT_EQ(manifest.first_frame, 5);
  ASSERT_THAT(manifest.cameras, SizeIs(3));
  for (const DepthManifestCamera& camera : manifest.cameras) {
    ASSERT_THAT(camera.files, SizeIs(2));
    EXPECT_EQ(camera.files[1].path, "depth/" + camera.camera.name + "/0006.png");
    for (const DepthManifestFile& file : camera.files) {
      const std::string bytes = ReadFileBytes((job.output() / file.path).string(), 1 << 20).value();
      EXPECT_EQ(Hex(Sha256(bytes)), file.sha256);
      const Grid<std::uint16_t> codes = DecodeDepthPng(bytes).value();
      EXPECT_EQ(codes.width(), camera.camera.width);
      EXPECT_EQ(codes.height(), camera.camera.height);
    }
  }
  EXPECT_EQ(manifest.cameras[2].input_sha256[1],
            Hex(Sha256(ReadFileBytes(job.picture(1, 2).string(), 1 << 20).value())));
  EXPECT_FALSE(fs::exists(job.output() / ".depthfarm-staging"));
  EXPECT_FALSE(fs::exists(job.output() / ".depthfarm-job"));
}

// Refined depth and confidence of version 9, as this code made them first (g++ 12, x86-64): who changes them raises
// kAlgorithmVersion, and then this digest.
TEST(TaskExecutor, DepthAndConfidenceAreThoseOfTheAlgorithmVersion) {
  constexpr const char* kPictures = "99da935a5c3dd127c7c33557f769a46cab0565262167c3a32cff805c26e8883a";
  constexpr const char* kMaps = "4b5a18b7d137c3baaca1b77719058c6837dadfbee90c338556277eca29c2c7b0";
  SmallJob job;
  job.config.resolved.params.confidence = true;
  std::string pictures;
  for (int frame = 0; frame < 2; ++frame)
    for (int view = 0; view < 3; ++view) pictures += ReadFileBytes(job.picture(frame, view).string(), 1 << 20).value();
  if (Hex(Sha256(pictures)) != kPictures) GTEST_SKIP() << "another sine gave other pictures";
  TestWorker worker;
  ASSERT_TRUE(job.RunOn({&worker}).ok());
  std::string codes;  // not the files: their bytes are also those of libpng and zlib
  for (const auto& [name, bytes] : Contents(job.output())) {
    if (!name.ends_with(".png")) continue;
    const Grid<std::uint16_t> map = DecodeDepthPng(bytes).value();
    for (const std::uint16_t code : map.values()) {
      codes.push_back(static_cast<char>(code & 0xFFU));
      codes.push_back(static_cast<char>(code >> 8U));
    }
  }
  EXPECT_EQ(kAlgorithmVersion, 12U);
  EXPECT_EQ(Hex(Sha256(codes)), kMaps);
}

TEST(TaskExecutor, TheResultDoesNotDependOnTheNumberOfWorkers) {
  SmallJob alone;
  TestWorker worker;
  ASSERT_TRUE(alone.RunOn({&worker}).ok());

  SmallJob shared;
  TestWorker a;
  TestWorker b;
  a.fetcher.stores = b.fetcher.stores = {a.store.get(), b.store.get()};
  const Status status = shared.RunOn({&a, &b});
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_GT(a.fetcher.fetches, 0);
  EXPECT_GT(b.fetcher.fetches, 0);
  EXPECT_EQ(Contents(shared.output()), Contents(alone.output()));
}

TEST(TaskExecutor, TheResultDoesNotDependOnTheNumberOfThreads) {
  SmallJob alone;
  TestWorker worker;
  ASSERT_TRUE(alone.RunOn({&worker}).ok());
  for (const int threads : {2, 3, 5}) {
    SmallJob shared;
    TestWorker other(threads);
    const Status status = shared.RunOn({&other});
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(Contents(shared.output()), Contents(alone.output())) << threads << " threads";
  }
}

TEST(TaskExecutor, ConfidenceIsWrittenBesideTheSameDepthOrMakesHolesInIt) {
  SmallJob plain;
  TestWorker worker;
  ASSERT_TRUE(plain.RunOn({&worker}).ok());
  const auto depth = Contents(plain.output());

  SmallJob with;
  with.config.resolved.params.confidence = true;
  TestWorker second;
  ASSERT_TRUE(with.RunOn({&second}).ok());
  auto contents = Contents(with.output());
  const DepthManifest manifest = ReadDepthManifest(with.output().string()).value();
  constexpr double kLeast = 0.9;
  int doubtful = 0;
  SmallJob holed;
  holed.config.resolved.params.holes = kLeast;
  TestWorker third;
  ASSERT_TRUE(holed.RunOn({&third}).ok());
  const auto with_holes = Contents(holed.output());
  for (const DepthManifestCamera& camera : manifest.cameras) {
    ASSERT_THAT(camera.confidence, SizeIs(2));
    for (std::size_t frame = 0; frame < 2; ++frame) {
      const std::string& path = camera.files[frame].path;
      EXPECT_EQ(contents.at(path), depth.at(path)) << "confidence changes no depth";
      const std::string& confidence_path = camera.confidence[frame].path;
      EXPECT_EQ(confidence_path, "confidence/" + camera.camera.name + "/000" + std::to_string(5 + frame) + ".png");
      EXPECT_EQ(Hex(Sha256(contents.at(confidence_path))), camera.confidence[frame].sha256);
      const Grid<std::uint16_t> codes = DecodeDepthPng(depth.at(path)).value();
      const Grid<std::uint16_t> confidence = DecodeDepthPng(contents.at(confidence_path)).value();
      const Grid<std::uint16_t> left = DecodeDepthPng(with_holes.at(path)).value();
      for (std::size_t i = 0; i < codes.size(); ++i) {
        const bool is_doubtful = confidence.values()[i] < kLeast * 65535;
        ASSERT_EQ(left.values()[i], is_doubtful ? 0 : codes.values()[i]);
        doubtful += is_doubtful ? 1 : 0;
      }
    }
  }
  EXPECT_GT(doubtful, 0);
  EXPECT_FALSE(with_holes.contains("confidence/" + manifest.cameras[0].camera.name + "/0005.png"));
}

TEST(TaskExecutor, TheSameDepthIsWrittenInAnyFormat) {
  SmallJob png;
  TestWorker first;
  ASSERT_TRUE(png.RunOn({&first}).ok());
  const DepthManifest expected = ReadDepthManifest(png.output().string()).value();
  for (const DepthFormat format : {DepthFormat::kPfm, DepthFormat::kExr, DepthFormat::kYuv420p16}) {
    SCOPED_TRACE(NameOf(format));
    SmallJob job;
    job.config.resolved.params.output_format = format;
    TestWorker worker;
    const Status status = job.RunOn({&worker});
    ASSERT_TRUE(status.ok()) << status.message();
    const DepthManifest manifest = ReadDepthManifest(job.output().string()).value();
    EXPECT_EQ(std::get<std::string>(manifest.parameters.at("outputFormat")), NameOf(format));
    ASSERT_EQ(manifest.cameras.size(), expected.cameras.size());
    for (std::size_t v = 0; v < manifest.cameras.size(); ++v) {
      const DepthManifestCamera& camera = manifest.cameras[v];
      EXPECT_EQ(camera.files[1].path, "depth/" + camera.camera.name + "/0006." + ExtensionOf(format));
      for (std::size_t frame = 0; frame < 2; ++frame) {
        EXPECT_TRUE(ReadDepthOf(job.output().string(), camera, frame).value() ==
                    ReadDepthOf(png.output().string(), expected.cameras[v], frame).value());
      }
    }
  }
}

TEST(TaskExecutor, MeasuresWhatATaskCost) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(AnalyseFirstFrame(job, worker).ok());
  const TaskStats stats = worker.Execute(job.Estimate(0, 0), job.config).stats;
  EXPECT_GT(stats.wall_seconds, 0);
  EXPECT_GE(stats.cpu_seconds, 0);
  EXPECT_GT(stats.peak_memory_bytes, 1 << 20);
  EXPECT_GT(stats.sweeps, 0);
  EXPECT_GT(stats.segments, 0);
  EXPECT_EQ(stats.nodes, stats.segments);  // an I frame adopts nothing
}

TEST(TaskExecutor, AJobThatKeepsItsResultsMakesTheSameFilesAsOneArtifact) {
  SmallJob job;
  job.config.resolved.params.confidence = true;
  TestWorker worker;
  const Status status = job.RunOn({&worker});
  ASSERT_TRUE(status.ok()) << status.message();

  JobConfig kept = job.config;
  kept.output_dir.clear();
  kept.keeps_results = true;
  TaskSpec emit = job.Emit(1);
  EXPECT_EQ(worker.Execute(emit, kept).status.code(), ErrorCode::kInvalidArgument) << "it has a staging folder";
  emit.staging.clear();
  emit.output_key = ArtifactKey{7};
  EXPECT_EQ(worker.Execute(emit, job.config).status.code(), ErrorCode::kInvalidArgument) << "it has none";
  const TaskOutcome made = worker.Execute(emit, kept);
  ASSERT_TRUE(made.status.ok()) << made.status.message();
  ASSERT_TRUE(made.artifact.has_value());
  EXPECT_FALSE(made.stats.reused);
  const std::string bundle = worker.store->Get(ArtifactKey{7}).value();
  const std::vector<BundledFile> files = DecodeFileBundle(bundle).value();
  ASSERT_THAT(files, SizeIs(6));
  ASSERT_THAT(made.files, SizeIs(6));
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string path(files[i].path);
    EXPECT_EQ(files[i].bytes, ReadFileBytes((job.output() / path).string(), 1 << 20).value()) << path;
    EXPECT_EQ(made.files[i], (OutputFile{path, Sha256(files[i].bytes), files[i].bytes.size()}));
  }
  EXPECT_EQ(files[3].path, "confidence/cam0/0006.png");

  const TaskOutcome again = worker.Execute(emit, kept);
  ASSERT_TRUE(again.status.ok()) << again.status.message();
  EXPECT_TRUE(again.stats.reused);
  EXPECT_EQ(again.files, made.files);
  EXPECT_EQ(again.artifact, made.artifact);
}

}  // namespace
}  // namespace depthfarm
