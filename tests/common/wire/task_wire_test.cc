#include "common/wire/task_wire.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

namespace depthfarm {
namespace {

std::array<std::uint8_t, 32> Digest(std::uint8_t seed) {
  std::array<std::uint8_t, 32> digest{};
  for (std::size_t i = 0; i < digest.size(); ++i) digest[i] = static_cast<std::uint8_t>(seed + 7 * i);
  return digest;
}

TaskSpec MergeSpec() {
  TaskSpec spec;
  spec.id = {JobId(3), 12, TaskKind::kMerge, 1, 2};
  spec.output_key = Digest(1);
  spec.inputs.push_back({{Digest(2), 77, Digest(3)}, InputRole::kAnalysis, 4, {{"ipc:///tmp/w", ""}}});
  spec.inputs.push_back(
      {{Digest(4), 78, Digest(5)}, InputRole::kLabels, 0, {{"tcp://a:1", std::string(40, 'k')}, {"tcp://b:2", ""}}});
  return spec;
}

TaskSpec CommitSpec() {
  TaskSpec spec;
  spec.id = {JobId(3), 12, TaskKind::kCommit, 0, 0};
  spec.staging = "f12-a2-l345";
  spec.files = {
      {"depth/cam0/0012.png", Digest(6), 1000}, {"views/0012.png", Digest(7), 1001}, {"depth/c/1.exr", Digest(8), 9}};
  return spec;
}

TaskSpec RenderSpec() {
  TaskSpec spec;
  spec.id = {JobId(3), 12, TaskKind::kRender, 0, 0};
  spec.staging = "f12-a2-l345";
  for (int i = 0; i < 2; ++i) {
    VirtualPicture view;
    view.frame = 5;
    view.sources = {"cam0", "cam1"};
    view.number = 96 + i;
    view.camera.name = "virtual";
    view.camera.width = 64;
    view.camera.height = 48;
    view.camera.intrinsics << 60, 0, 31.5, 0, 60, 23.5, 0, 0, 1;
    view.camera.cam_from_world_translation << 0.5, 0, i;
    spec.views.push_back(view);
  }
  return spec;
}

TEST(TaskSpecWire, EveryFieldComesBack) {
  TaskSpec analyse;
  analyse.id = {JobId(3), 12, TaskKind::kAnalyse, 4, 0};
  analyse.picture = "/data/a b.png";
  analyse.known = TaskInput{{Digest(8), 79, Digest(9)}, InputRole::kAnalysis, 4, {{"ipc:///tmp/w", ""}}};
  TaskSpec manifest;
  manifest.id = {JobId(3), 0, TaskKind::kManifest, 0, 0};
  manifest.files = CommitSpec().files;
  manifest.picture_digests = {Digest(8), Digest(9)};
  TaskSpec guided = analyse;
  guided.guides = {"/masks/0.png", "/prior/0.pfm", "/prior/c0.png"};
  for (const TaskSpec& sent : {MergeSpec(), CommitSpec(), RenderSpec(), analyse, guided, manifest}) {
    const Result<TaskSpec> got = FromProto(ToProto(sent));
    ASSERT_TRUE(got.ok()) << got.status().message();
    EXPECT_EQ(*got, sent);
  }
}

TEST(TaskSpecWire, EveryRoleAndKindComesBack) {
  for (int role = 0; role <= static_cast<int>(InputRole::kLabels); ++role) {
    TaskSpec spec = MergeSpec();
    spec.inputs[0].role = static_cast<InputRole>(role);
    EXPECT_EQ(FromProto(ToProto(spec)).value(), spec);
  }
  for (int kind = 0; kind <= static_cast<int>(TaskKind::kCleanup); ++kind) {
    EXPECT_EQ(FromProto(ToProto(static_cast<TaskKind>(kind))).value(), static_cast<TaskKind>(kind));
  }
}

TEST(TaskSpecWire, HostileValuesAreRefused) {
  using Damage = std::function<void(v1::TaskSpec&)>;
  const auto refused = [](const TaskSpec& spec, const Damage& damage) {
    v1::TaskSpec proto = ToProto(spec);
    damage(proto);
    return FromProto(proto).status().code() == ErrorCode::kInvalidArgument;
  };
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.mutable_id()->clear_kind(); }));
  EXPECT_TRUE(refused(RenderSpec(), [](auto& s) { s.clear_staging(); }));
  EXPECT_TRUE(refused(RenderSpec(), [](auto& s) { s.mutable_views(0)->clear_sources(); }));
  EXPECT_TRUE(refused(RenderSpec(), [](auto& s) { s.mutable_views(0)->add_sources("../x"); }));
  EXPECT_TRUE(refused(RenderSpec(), [](auto& s) { s.mutable_views(0)->set_number(97); }));  // another view's
  EXPECT_TRUE(refused(RenderSpec(), [](auto& s) { s.mutable_views(1)->set_frame(4'000'000'000U); }));
  EXPECT_TRUE(refused(RenderSpec(), [](auto& s) { s.mutable_views(1)->mutable_camera()->set_width(0); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.mutable_id()->set_frame(4'000'000'000U); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.mutable_id()->set_pair(70'000); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.clear_output_key(); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.set_output_key("short"); }));
  EXPECT_TRUE(refused(CommitSpec(), [](auto& s) { s.set_output_key(std::string(32, 'k')); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.mutable_inputs(0)->set_key("short"); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.mutable_inputs(0)->clear_content_digest(); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.mutable_inputs(0)->clear_role(); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.mutable_inputs(0)->set_view(1024); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.mutable_inputs(0)->set_stored_bytes(~std::uint64_t{0}); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.mutable_inputs(0)->mutable_locations(0)->clear_endpoint(); }));
  EXPECT_TRUE(refused(MergeSpec(), [](auto& s) { s.mutable_inputs(0)->mutable_locations(0)->set_public_key("k"); }));
  EXPECT_TRUE(refused(CommitSpec(), [](auto& s) { s.set_staging(".."); }));
  EXPECT_TRUE(refused(CommitSpec(), [](auto& s) { s.clear_staging(); }));
  for (const char* path :
       {"", "a.png", "../a.png", "a/../b.png", "/a.png", "a/b/c/d.png", "a//b.png", "a/b.exe", "./a.png", "a/\n.png"}) {
    EXPECT_TRUE(refused(CommitSpec(), [&](auto& s) { s.mutable_files(0)->set_path(path); })) << path;
  }
}

TEST(ArtifactInfoWire, ComesBackAndRefusesEmptyOrHugeOnes) {
  const ArtifactInfo sent{Digest(1), 500, Digest(2)};
  EXPECT_EQ(FromProto(ToProto(sent)).value(), sent);
  EXPECT_FALSE(FromProto(ToProto(ArtifactInfo{Digest(1), 0, Digest(2)})).ok());
  EXPECT_FALSE(FromProto(ToProto(ArtifactInfo{Digest(1), std::uint64_t{1} << 40, Digest(2)})).ok());
}

TEST(TaskStatsWire, EveryFieldComesBackAndNonsenseCountsNothing) {
  const TaskStats sent{1.5, 1.25, 1 << 20, 0.5, 4096, 3, -17, 9, 11, true, true};
  EXPECT_EQ(FromProto(ToProto(sent)), sent);
  v1::TaskStats hostile;
  hostile.set_wall_seconds(std::numeric_limits<double>::quiet_NaN());
  hostile.set_cpu_seconds(-std::numeric_limits<double>::infinity());
  EXPECT_EQ(FromProto(hostile), TaskStats());
}

TEST(TaskSpecWire, EmitHasAStagingFolderOrAnOutputKey) {
  TaskSpec emit;
  emit.id = {JobId(3), 2, TaskKind::kEmit, 0, 0};
  emit.staging = "f2-a1-l5";
  EXPECT_EQ(FromProto(ToProto(emit)).value(), emit);
  emit.output_key = Digest(4);
  EXPECT_FALSE(FromProto(ToProto(emit)).ok());
  emit.staging.clear();
  EXPECT_EQ(FromProto(ToProto(emit)).value(), emit);
  emit.output_key.reset();
  EXPECT_FALSE(FromProto(ToProto(emit)).ok());
}

TEST(TaskLogWire, ComesBackWithinItsBounds) {
  const TaskLog sent{{"warning slow seconds=3", "libpng error: Read Error"}, 7};
  EXPECT_EQ(FromProto(ToProto(sent)), sent);

  v1::TaskLog many;
  for (int i = 0; i < 100; ++i) many.add_lines("line " + std::to_string(i));
  const TaskLog last = FromProto(many);
  EXPECT_EQ(last.lines.size(), 64U);
  EXPECT_EQ(last.lines.back(), "line 99");
  EXPECT_EQ(last.left_out, 36U);

  v1::TaskLog wide;
  for (int i = 0; i < 20; ++i) wide.add_lines(std::string(5000, 'x'));
  EXPECT_EQ(FromProto(wide).lines.size(), 8U);
  EXPECT_EQ(FromProto(wide).lines.front().size(), 2048U);

  v1::TaskLog hostile;
  hostile.add_lines("a\x1b[31mb");
  EXPECT_EQ(FromProto(hostile).lines.front(), "a?[31mb");
}

TEST(TaskSpecWire, UploadsComeBackAndFitTheFilesOfTheTask) {
  TaskSpec spec;
  spec.id = {JobId(3), 2, TaskKind::kAnalyse, 1, 0};
  spec.picture = "/there/0.png";
  spec.guides.mask = "/there/mask.png";
  spec.uploads = UploadedSources{{.picture = {{Digest(1), 100}, Digest(3)},
                                  .mask = UploadedFile{{Digest(2), 50}, Digest(4)},
                                  .prior = {},
                                  .prior_confidence = {}},
                                 {"tcp://submitter:1", std::string(40, 'k')}};
  EXPECT_EQ(FromProto(ToProto(spec)).value(), spec);
  const auto refused = [&](const std::function<void(v1::TaskSpec&)>& damage) {
    v1::TaskSpec proto = ToProto(spec);
    damage(proto);
    return FromProto(proto).status().code() == ErrorCode::kInvalidArgument;
  };
  EXPECT_TRUE(refused([](auto& s) { s.clear_picture_upload(); }));
  EXPECT_TRUE(refused([](auto& s) { s.mutable_picture_upload()->clear_artifact_digest(); }));
  EXPECT_TRUE(refused([](auto& s) { s.clear_mask_upload(); }));
  EXPECT_TRUE(refused([](auto& s) { s.mutable_prior_upload()->mutable_file()->set_bytes(1); }));
  EXPECT_TRUE(refused([](auto& s) { s.mutable_picture_upload()->mutable_file()->set_bytes(std::uint64_t{1} << 40); }));
  EXPECT_TRUE(refused([](auto& s) { s.mutable_picture_upload()->mutable_file()->set_sha256("short"); }));
  EXPECT_TRUE(refused([](auto& s) { s.mutable_uploads_from()->clear_endpoint(); }));
}

}  // namespace
}  // namespace depthfarm
