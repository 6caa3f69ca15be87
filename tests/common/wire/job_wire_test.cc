#include "common/wire/job_wire.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "common/wire/sequence_wire.h"

namespace depthfarm {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Camera TestCamera(const std::string& name, double x) {
  Camera camera;
  camera.name = name;
  camera.width = 320;
  camera.height = 240;
  camera.intrinsics << 300.25, 0.5, 159.75, 0, 301.5, 119.25, 0, 0, 1;
  camera.cam_from_world_rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  camera.cam_from_world_translation << x, 0.125, -3;
  return camera;
}

void ExpectEqual(const Camera& a, const Camera& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.intrinsics, b.intrinsics);
  EXPECT_EQ(a.cam_from_world_rotation, b.cam_from_world_rotation);
  EXPECT_EQ(a.cam_from_world_translation, b.cam_from_world_translation);
}

Sequence TestSequence() {
  Sequence sequence;
  sequence.name = "arc";
  sequence.file = "/data/arc.json";
  sequence.z_near = 2;
  sequence.z_far = 9.5;
  sequence.frame_rate = 25;
  sequence.reference = "cam1";
  for (int i = 0; i < 3; ++i) {
    SequenceCamera camera;
    camera.camera = TestCamera("cam" + std::to_string(i), i);
    camera.format = {PictureFormat::Kind::kYuv420, 10, true, true};
    camera.images = {"/data/" + std::to_string(i) + "/0.yuv", "/data/" + std::to_string(i) + "/1.yuv"};
    if (i > 0) camera.images.back() = camera.images.front();  // videos, see below
    if (i == 1) camera.format = {.kind = PictureFormat::Kind::kYuv422, .bits = 12, .bt709 = true, .all_frames = true};
    if (i == 2) camera.format = {.kind = PictureFormat::Kind::kVideo, .full_range = true, .colour_said = true};
    if (i == 1) camera.z_near = 1.5;
    if (i == 1) camera.masks = {"", "/masks/1.png"};
    if (i == 2) camera.prior = {"/prior/0.pfm", ""};
    if (i == 2) camera.prior_confidence = {"/prior/c0.png", ""};
    if (i == 2) camera.prior_format = {PriorFormat::Holds::kCodes, 0.001, 2, 9};
    if (i == 2) camera.z_far = 11;
    sequence.cameras.push_back(camera);
  }
  return sequence;
}

EstimationParams TestParams() {
  EstimationParams params;
  params.segments = 1000;
  params.levels = 40;
  params.z_near = 2.5;
  params.z_far = 9;
  params.smoothing = 1.25;
  params.matching_window = 5;
  params.matching_offset = 31;
  params.uniqueness = 60;
  params.snic_compactness = 6.5;
  params.gop = 4;
  params.anchor = Anchor::kShared;
  params.p_threshold = 4;
  params.i_threshold = 2;
  params.level_blocks = 8;
  params.partition = Partition::kContiguous;
  params.segment_pixels = 31;
  params.choice_rounds = 3;
  params.compared = 2;
  params.search = Search::kFull;
  params.max_sweeps = 9;
  params.neighbours = 1;
  params.refine_rounds = 7;
  params.confidence = true;
  params.output_format = DepthFormat::kExr;
  params.holes = 0.25;
  params.downscale = 2;
  params.views = {"cam0", "cam2"};
  params.first_frame = 3;
  params.end_frame = 13;
  return params;
}

JobConfig TestConfig() {
  JobConfig config;
  config.job = JobId(12);
  config.algorithm_version = 5;
  config.output_dir = "/out/arc";
  config.claim = 77;
  config.sequence_name = "arc";
  config.sequence_file = "/data/arc.json";
  config.resolved.params = TestParams();
  config.resolved.reference = TestCamera("cam1", 1);
  config.resolved.num_frames = 10;
  config.resolved.level_blocks_i = 8;
  config.resolved.level_blocks_p = 2;
  for (int i = 0; i < 2; ++i) {
    JobView view;
    view.camera = TestCamera("cam" + std::to_string(2 * i), i);
    view.source_width = 641;
    view.source_height = 480;
    view.format = {PictureFormat::Kind::kYuv400, 16, false, true};
    view.segments = 1000 + i;
    view.own_range = {2.25, 9.75};
    view.prior = {PriorFormat::Holds::kDepth, 0.5 + i, 0, 0};
    view.masked = i == 1;
    view.neighbours = {1 - i};
    view.compared = {1 - i};
    config.resolved.views.push_back(view);
  }
  return config;
}

TEST(SequenceWire, EveryFieldComesBack) {
  const Sequence sent = TestSequence();
  const Result<Sequence> got = FromProto(ToProto(sent));
  ASSERT_TRUE(got.ok()) << got.status().message();
  EXPECT_EQ(got->name, sent.name);
  EXPECT_EQ(got->file, sent.file);
  EXPECT_EQ(got->z_near, sent.z_near);
  EXPECT_EQ(got->z_far, sent.z_far);
  EXPECT_EQ(got->frame_rate, sent.frame_rate);
  EXPECT_EQ(got->reference, sent.reference);
  ASSERT_EQ(got->cameras.size(), sent.cameras.size());
  for (std::size_t i = 0; i < sent.cameras.size(); ++i) {
    ExpectEqual(got->cameras[i].camera, sent.cameras[i].camera);
    EXPECT_EQ(got->cameras[i].format, sent.cameras[i].format);
    EXPECT_EQ(got->cameras[i].images, sent.cameras[i].images);
    EXPECT_EQ(got->cameras[i].masks, sent.cameras[i].masks);
    EXPECT_EQ(got->cameras[i].prior, sent.cameras[i].prior);
    EXPECT_EQ(got->cameras[i].prior_confidence, sent.cameras[i].prior_confidence);
    EXPECT_EQ(got->cameras[i].prior_format, sent.cameras[i].prior_format);
    EXPECT_EQ(got->cameras[i].z_near, sent.cameras[i].z_near);
    EXPECT_EQ(got->cameras[i].z_far, sent.cameras[i].z_far);
  }
}

TEST(SequenceWire, HostileValuesAreRefused) {
  using Damage = std::function<void(v1::Sequence&)>;
  const auto camera = [](v1::Sequence& s) { return s.mutable_cameras(1)->mutable_camera(); };
  const std::vector<std::pair<const char*, Damage>> damages = {
      {"no name", [&](v1::Sequence& s) { camera(s)->set_name(""); }},
      {"name leaves the folder", [&](v1::Sequence& s) { camera(s)->set_name(".."); }},
      {"name is a path", [&](v1::Sequence& s) { camera(s)->set_name("a/b"); }},
      {"name with control character", [&](v1::Sequence& s) { camera(s)->set_name("a\nb"); }},
      {"long name", [&](v1::Sequence& s) { camera(s)->set_name(std::string(201, 'a')); }},
      {"name twice", [&](v1::Sequence& s) { camera(s)->set_name("cam0"); }},
      {"huge", [&](v1::Sequence& s) { camera(s)->set_width(4'000'000'000U); }},
      {"flat", [&](v1::Sequence& s) { camera(s)->set_height(0); }},
      {"short K", [&](v1::Sequence& s) { camera(s)->mutable_k()->RemoveLast(); }},
      {"long R", [&](v1::Sequence& s) { camera(s)->add_r(1); }},
      {"short t", [&](v1::Sequence& s) { camera(s)->mutable_t()->RemoveLast(); }},
      {"NaN in K", [&](v1::Sequence& s) { camera(s)->set_k(2, kNaN); }},
      {"NaN in R", [&](v1::Sequence& s) { camera(s)->set_r(0, kNaN); }},
      {"infinite t", [&](v1::Sequence& s) { camera(s)->set_t(0, kInfinity); }},
      {"no rotation", [&](v1::Sequence& s) { camera(s)->set_r(8, 2); }},
      {"relative picture", [](v1::Sequence& s) { s.mutable_cameras(0)->set_images(0, "a.png"); }},
      {"NUL in picture", [](v1::Sequence& s) { s.mutable_cameras(0)->set_images(0, std::string("/a\0b", 4)); }},
      {"long path", [](v1::Sequence& s) { s.mutable_cameras(0)->set_images(0, "/" + std::string(4096, 'a')); }},
      {"no kind", [](v1::Sequence& s) { s.mutable_cameras(0)->mutable_format()->clear_kind(); }},
      {"17 bits", [](v1::Sequence& s) { s.mutable_cameras(0)->mutable_format()->set_bits(17); }},
      {"7 bits", [](v1::Sequence& s) { s.mutable_cameras(0)->mutable_format()->set_bits(7); }},
      {"all frames of image files",
       [](v1::Sequence& s) { s.mutable_cameras(1)->mutable_format()->set_kind(v1::PICTURE_KIND_IMAGE); }},
      {"all frames told twice", [](v1::Sequence& s) { s.mutable_cameras(2)->mutable_format()->set_all_frames(true); }},
      {"two files of a video", [](v1::Sequence& s) { s.mutable_cameras(2)->set_images(1, "/other.mp4"); }},
      {"colour of pictures said twice",
       [](v1::Sequence& s) { s.mutable_cameras(0)->mutable_format()->set_colour_said(true); }},
      {"a kind of later",
       [](v1::Sequence& s) { s.mutable_cameras(0)->mutable_format()->set_kind(static_cast<v1::PictureKind>(7)); }},
      {"negative zNear", [](v1::Sequence& s) { s.set_z_near(-1); }},
      {"NaN zFar", [](v1::Sequence& s) { s.mutable_cameras(0)->set_z_far(kNaN); }},
      {"one mask for two frames", [](v1::Sequence& s) { s.mutable_cameras(0)->add_masks("/m.png"); }},
      {"relative mask", [](v1::Sequence& s) { s.mutable_cameras(1)->set_masks(1, "m.png"); }},
      {"relative prior", [](v1::Sequence& s) { s.mutable_cameras(2)->set_prior(1, "p.pfm"); }},
      {"three priors for two frames", [](v1::Sequence& s) { s.mutable_cameras(2)->add_prior("/p.pfm"); }},
      {"relative confidence", [](v1::Sequence& s) { s.mutable_cameras(2)->set_prior_confidence(1, "c.png"); }},
      {"unknown prior",
       [](v1::Sequence& s) {
         s.mutable_cameras(2)->mutable_prior_format()->set_content(static_cast<v1::PriorContent>(5));
       }},
      {"priors of no format", [](v1::Sequence& s) { s.mutable_cameras(2)->clear_prior_format(); }},
      {"no unit", [](v1::Sequence& s) { s.mutable_cameras(2)->mutable_prior_format()->set_unit(0); }},
      {"NaN unit", [](v1::Sequence& s) { s.mutable_cameras(2)->mutable_prior_format()->set_unit(kNaN); }},
      {"empty range of codes", [](v1::Sequence& s) { s.mutable_cameras(2)->mutable_prior_format()->set_z_far(2); }},
      {"NaN rate", [](v1::Sequence& s) { s.set_frame_rate(kNaN); }},
      {"too many cameras",
       [](v1::Sequence& s) {
         for (int i = 0; i < 1025; ++i) s.add_cameras();
       }},
  };
  for (const auto& [name, damage] : damages) {
    v1::Sequence proto = ToProto(TestSequence());
    damage(proto);
    EXPECT_EQ(FromProto(proto).status().code(), ErrorCode::kInvalidArgument) << name;
  }
}

TEST(ParamsWire, EveryFieldComesBack) {
  const Result<EstimationParams> got = FromProto(ToProto(TestParams()));
  ASSERT_TRUE(got.ok()) << got.status().message();
  EXPECT_EQ(*got, TestParams());
  EXPECT_EQ(FromProto(ToProto(EstimationParams())).value(), EstimationParams());
}

TEST(ParamsWire, HostileValuesAreRefused) {
  const auto refused = [](const std::function<void(v1::EstimationParams&)>& damage) {
    v1::EstimationParams proto = ToProto(TestParams());
    damage(proto);
    return FromProto(proto).status().code() == ErrorCode::kInvalidArgument;
  };
  EXPECT_TRUE(refused([](auto& p) { p.set_segments(4'294'967'295U); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_gop(0); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_gop(2'000'000); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_one_gop(true); }));  // and a length
  EXPECT_TRUE(refused([](auto& p) { p.set_smoothing(kNaN); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_z_near(kNaN); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_z_far(kInfinity); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_matching_offset(kInfinity); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_uniqueness(100); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_holes(1); }));
  EXPECT_TRUE(refused([](auto& p) { p.clear_partition(); }));
  EXPECT_TRUE(refused([](auto& p) { p.clear_search(); }));
  EXPECT_TRUE(refused([](auto& p) { p.clear_compared(); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_choice_rounds(101); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_output_format(static_cast<v1::DepthFormat>(4)); }));
  EXPECT_TRUE(refused([](auto& p) { p.clear_segment_pixels(); }));
  EXPECT_TRUE(refused([](auto& p) { p.add_views("../x"); }));
  EXPECT_TRUE(refused([](auto& p) { p.add_views("cam0"); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_end_frame(-2); }));
}

TEST(ParamsWire, OneGopForAllFramesComesBack) {
  EstimationParams params = TestParams();
  params.gop = 0;
  EXPECT_EQ(FromProto(ToProto(params)).value(), params);
}

TEST(JobConfigWire, AResolvedJobHasAGopOfFrames) {
  JobConfig config = TestConfig();
  config.resolved.params.gop = 0;
  EXPECT_THAT(FromProto(ToProto(config)).status().message(), testing::HasSubstr("gop"));
}

TEST(JobConfigWire, EveryFieldComesBack) {
  const JobConfig sent = TestConfig();
  const Result<JobConfig> got = FromProto(ToProto(sent));
  ASSERT_TRUE(got.ok()) << got.status().message();
  EXPECT_EQ(got->job, sent.job);
  EXPECT_EQ(got->algorithm_version, sent.algorithm_version);
  EXPECT_EQ(got->output_dir, sent.output_dir);
  EXPECT_EQ(got->claim, sent.claim);
  EXPECT_EQ(got->sequence_name, sent.sequence_name);
  EXPECT_EQ(got->sequence_file, sent.sequence_file);
  const ResolvedJob& a = got->resolved;
  const ResolvedJob& b = sent.resolved;
  EXPECT_EQ(a.params, b.params);
  ExpectEqual(a.reference, b.reference);
  EXPECT_EQ(a.num_frames, b.num_frames);
  EXPECT_EQ(a.level_blocks_i, b.level_blocks_i);
  EXPECT_EQ(a.level_blocks_p, b.level_blocks_p);
  ASSERT_EQ(a.views.size(), b.views.size());
  for (std::size_t i = 0; i < a.views.size(); ++i) {
    ExpectEqual(a.views[i].camera, b.views[i].camera);
    EXPECT_EQ(a.views[i].source_width, b.views[i].source_width);
    EXPECT_EQ(a.views[i].source_height, b.views[i].source_height);
    EXPECT_EQ(a.views[i].format, b.views[i].format);
    EXPECT_EQ(a.views[i].segments, b.views[i].segments);
    EXPECT_EQ(a.views[i].prior, b.views[i].prior);
    EXPECT_EQ(a.views[i].masked, b.views[i].masked);
    EXPECT_EQ(a.views[i].own_range.z_near, b.views[i].own_range.z_near);
    EXPECT_EQ(a.views[i].own_range.z_far, b.views[i].own_range.z_far);
    EXPECT_EQ(a.views[i].neighbours, b.views[i].neighbours);
    EXPECT_EQ(a.views[i].compared, b.views[i].compared);
  }
}

JobConfig RenderingConfig() {
  JobConfig config;
  config.job = JobId(9);
  config.output_dir = "/out";
  config.sequence_name = "line";
  config.sequence_file = "/in/line.json";
  config.render = RenderSource{"/depth", {1, 2, 3}};
  config.resolved = PartsOnly(7);
  return config;
}

TEST(JobConfigWire, ARenderingJobComesBack) {
  const JobConfig sent = RenderingConfig();
  const Result<JobConfig> got = FromProto(ToProto(sent));
  ASSERT_TRUE(got.ok()) << got.status().message();
  EXPECT_EQ(got->render, sent.render);
  EXPECT_EQ(got->sequence_file, sent.sequence_file);
  EXPECT_EQ(got->resolved.params, sent.resolved.params);
  EXPECT_EQ(got->resolved.num_frames, 7);
}

TEST(JobConfigWire, HostileRenderingJobsAreRefused) {
  using Damage = std::function<void(v1::JobConfig&)>;
  const std::vector<std::pair<const char*, Damage>> damages = {
      {"relative depth", [](v1::JobConfig& c) { c.mutable_render()->set_depth_dir("depth"); }},
      {"no digest", [](v1::JobConfig& c) { c.mutable_render()->clear_manifest_sha256(); }},
      {"no parts", [](v1::JobConfig& c) { c.set_num_frames(0); }},
      {"too many parts", [](v1::JobConfig& c) { c.set_num_frames(4'000'000'000U); }},
      {"relative sequence", [](v1::JobConfig& c) { c.set_sequence_file("line.json"); }},
      {"relative output", [](v1::JobConfig& c) { c.set_output_dir("out"); }},
  };
  for (const auto& [name, damage] : damages) {
    v1::JobConfig proto = ToProto(RenderingConfig());
    damage(proto);
    EXPECT_EQ(FromProto(proto).status().code(), ErrorCode::kInvalidArgument) << name;
  }
}

TEST(JobConfigWire, HostileValuesAreRefused) {
  using Damage = std::function<void(v1::JobConfig&)>;
  const std::vector<std::pair<const char*, Damage>> damages = {
      {"no levels", [](v1::JobConfig& c) { c.mutable_params()->set_levels(0); }},
      {"no range", [](v1::JobConfig& c) { c.mutable_params()->set_z_near(0); }},
      {"range the wrong way", [](v1::JobConfig& c) { c.mutable_params()->set_z_near(100); }},
      {"no frames", [](v1::JobConfig& c) { c.set_num_frames(0); }},
      {"frames that differ", [](v1::JobConfig& c) { c.set_num_frames(11); }},
      {"open end", [](v1::JobConfig& c) { c.mutable_params()->set_end_frame(-1); }},
      {"no blocks", [](v1::JobConfig& c) { c.set_level_blocks_p(0); }},
      {"more blocks than levels", [](v1::JobConfig& c) { c.set_level_blocks_i(41); }},
      {"one view", [](v1::JobConfig& c) { c.mutable_views()->RemoveLast(); }},
      {"the same view twice", [](v1::JobConfig& c) { c.mutable_views(1)->mutable_camera()->set_name("cam0"); }},
      {"neighbour out of range", [](v1::JobConfig& c) { c.mutable_views(0)->set_neighbours(0, 2); }},
      {"neighbour is itself", [](v1::JobConfig& c) { c.mutable_views(0)->set_neighbours(0, 0); }},
      {"compared with itself", [](v1::JobConfig& c) { c.mutable_views(1)->set_compared(0, 1); }},
      {"compared with no view", [](v1::JobConfig& c) { c.mutable_views(1)->clear_compared(); }},
      {"compared with five views",
       [](v1::JobConfig& c) {
         for (std::uint32_t i = 2; i < 6; ++i) {
           v1::JobView view = c.views(1);
           view.mutable_camera()->set_name("more" + std::to_string(i));
           *c.add_views() = view;
           c.mutable_views(0)->add_compared(i);
         }
       }},
      {"too many rounds", [](v1::JobConfig& c) { c.mutable_params()->set_refine_rounds(101); }},
      {"no neighbour", [](v1::JobConfig& c) { c.mutable_views(0)->clear_neighbours(); }},
      {"neighbour twice", [](v1::JobConfig& c) { c.mutable_views(0)->add_neighbours(1); }},
      {"no segments", [](v1::JobConfig& c) { c.mutable_views(0)->set_segments(0); }},
      {"more segments than pixels", [](v1::JobConfig& c) { c.mutable_views(0)->set_segments(320 * 240 + 1); }},
      {"source of another size", [](v1::JobConfig& c) { c.mutable_views(0)->set_source_width(642); }},
      {"own range NaN", [](v1::JobConfig& c) { c.mutable_views(0)->mutable_own_range()->set_z_far(kNaN); }},
      {"own range of no extent", [](v1::JobConfig& c) { c.mutable_views(0)->mutable_own_range()->set_z_far(2.25); }},
      {"own range zero", [](v1::JobConfig& c) { c.mutable_views(0)->mutable_own_range()->set_z_near(0); }},
      {"relative output", [](v1::JobConfig& c) { c.set_output_dir("out"); }},
      {"NUL in output", [](v1::JobConfig& c) { c.set_output_dir(std::string("/a\0b", 4)); }},
      {"no reference", [](v1::JobConfig& c) { c.clear_reference(); }},
  };
  for (const auto& [name, damage] : damages) {
    v1::JobConfig proto = ToProto(TestConfig());
    damage(proto);
    EXPECT_EQ(FromProto(proto).status().code(), ErrorCode::kInvalidArgument) << name;
  }
}

}  // namespace
}  // namespace depthfarm
