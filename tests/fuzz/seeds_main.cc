// Writes good inputs of the fuzz targets: what real encoders make of a small sequence. The same every time, for one
// version of the libraries that compress.
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/compression/zstd_frame.h"
#include "common/files/atomic_file.h"
#include "common/files/file_bundle.h"
#include "common/media/depth_file.h"
#include "common/media/exr.h"
#include "common/media/grey_picture.h"
#include "common/media/pfm.h"
#include "common/media/raw_picture.h"
#include "common/sequence/depth_manifest.h"
#include "common/sequence/read_sequence.h"
#include "common/wire/digest_wire.h"
#include "common/wire/envelope.h"
#include "common/wire/job_wire.h"
#include "common/wire/render_wire.h"
#include "common/wire/results_wire.h"
#include "common/wire/sequence_wire.h"
#include "common/wire/task_wire.h"
#include "coordinator/journal/frame_codec.h"
#include "coordinator/service/submission.h"
#include "tests/common/video_input/written_video.h"
#include "tests/support/calibration_samples.h"
#include "tests/support/temporary_folder.h"
#include "worker/confidence/confidence_codec.h"
#include "worker/estimation/label_field_codec.h"
#include "worker/refinement/refined_view_codec.h"
#include "worker/segmentation/analysis_codec.h"
#include "worker/segmentation/describe.h"

namespace {

using namespace depthfarm;

using Seeds = std::map<std::string, std::string>;  // "target/name" -> bytes

constexpr int kWidth = 16;
constexpr int kHeight = 12;
constexpr std::size_t kArtifactPrefix = 8;  // magic and version

constexpr std::string_view kSequence = R"({
 "name": "two", "zNear": 2, "zFar": 9.5, "frameRate": 25, "reference": "a", "notes": "made for tests",
 "convention": "x_cam = R*X_world + t, +z forward, +y down, pixels (0,0)=centre of top-left pixel",
 "cameras": [
  {"name": "a", "width": 320, "height": 240, "K": [[300, 0, 159.5], [0, 300, 119.5], [0, 0, 1]],
   "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [0, 0, 0], "zNear": 1.5, "zFar": 10,
   "images": ["a/0.png", "a/1.png"], "masks": ["m/0.png", "m/1.png"], "depth": ["d/0.png", "d/1.png"]},
  {"name": "b", "width": 320, "height": 240, "K": [[300, 0, 159.5], [0, 300, 119.5], [0, 0, 1]],
   "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [-0.2, 0, 0], "x-key": null,
   "images": ["b/0.yuv", "b/1.yuv"], "format": "yuv420p10le", "range": "full", "matrix": "bt709"},
  {"name": "c", "width": 160, "height": 120, "K": [[150, 0.5, 79.5], [0, 150, 59.5], [0, 0, 1]],
   "R": [[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]], "t": [-0.4, 0.1, 0.5], "images": []}],
 "groundTruth": )";
constexpr std::string_view kListedTruth = R"({"encoding": "z-pfm", "zones": {"thin": 3},
  "views": [{"view": "a", "depth": ["gt/0.pfm", "gt/1.pfm"], "zones": ["z/0.png", "z/1.png"]}]}})";
constexpr std::string_view kWordedTruth = R"json({"view": "a", "file": "gt.png", "masks": "nonocc.png: 255 is counted",
  "encoding": "8-bit, disparity = value/4, 0 = unknown", "depth": "z = 450.0/(disparity + 3.5)"}})json";
constexpr std::string_view kCameras = R"({"cameras": [
 {"name": "v0", "width": 64, "height": 48, "K": [[60, 0, 31.5], [0, 60, 23.5], [0, 0, 1]],
  "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [0, 0, 0]},
 {"name": "v1", "width": 32, "height": 24, "K": [[30, 0, 15.5], [0, 30, 11.5], [0, 0, 1]],
  "R": [[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]], "t": [0.1, 0, 1], "notes": "turned"}]})";
constexpr std::string_view kParams = R"({"preset": "fast", "levels": 64, "segments": "auto", "views": ["a", "b"],
 "frames": "0:50", "gop": "all", "anchor": "shared", "z-near": 1.5, "smoothing": 0.5, "partition": "blocks",
 "sweeps": "auto", "confidence": "on", "holes": 0.25, "downscale": 2, "prior": "folder", "mask": "sequence"})";
constexpr std::string_view kViews =
    R"({"views": [{"file": "views/0000.png", "sha256": "00", "frame": 0}], "sequence": "two"})";
constexpr std::string_view kPrior = R"({"holds": "inverse-depth", "unit": 0.001, "still": true, "notes": "scanned"})";

YcbcrImage SmallPicture() {
  YcbcrImage picture(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool object = x > 4 && x < 11 && y > 3;
      picture(x, y) = {static_cast<std::uint8_t>(object ? 200 - 3 * y : 40 + 5 * x),
                       static_cast<std::uint8_t>(object ? 90 : 128), static_cast<std::uint8_t>(120 + x)};
      picture(x, y).matte = object ? kForegroundMatte : 0;
    }
  }
  return picture;
}

std::array<std::uint8_t, 32> Digest(unsigned seed) {
  std::array<std::uint8_t, 32> digest{};
  for (std::size_t i = 0; i < digest.size(); ++i) digest[i] = static_cast<std::uint8_t>(seed + 7 * i);
  return digest;
}

// The artifact itself, and its content, which fuzz targets pack again.
void AddArtifact(const std::string& target, const std::string& name, const std::string& bytes, Seeds& seeds) {
  seeds[target + "/" + name] = bytes;
  seeds[target + "/" + name + "-content"] =
      ReadZstdFrame(std::string_view(bytes).substr(kArtifactPrefix), 1, 1 << 20).value();
}

void AddArtifacts(Seeds& seeds) {
  ViewAnalysis analysis = AnalyseView(SmallPicture(), 12, 5).value();
  AddArtifact("view_analysis", "masked", EncodeAnalysis(analysis), seeds);
  Grid<float> values(kWidth, kHeight);
  Grid<float> confidence(kWidth, kHeight, 0.75F);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 3; x < kWidth; ++x) values(x, y) = 0.01F * static_cast<float>(x) + 0.002F * static_cast<float>(y);
  analysis.prior = MakePrior(values, confidence);
  analysis.prior.segments = DescribePrior(analysis.segments, analysis.prior);
  AddArtifact("view_analysis", "guided", EncodeAnalysis(analysis), seeds);

  LabelField field;
  for (int view = 0; view < 2; ++view) {
    ViewLabels& labels = field.views.emplace_back();
    for (int s = 0; s < 9 + view; ++s) {
      labels.levels.push_back(static_cast<Level>(s * s * 30));
      labels.unchanged.push_back(s % 3 == 0 ? 1 : 0);
    }
  }
  AddArtifact("label_field", "two-views", EncodeLabelField(field), seeds);

  RefinedView refined{.planes = {{0.25F, -1e-3F, 7}, {0, 0, -2.5F}, {1e-20F, 3, 1e6F}, {0.1F, 0.2F, 0.3F}},
                      .kept = {0, 1, 0},
                      .plane_of_pixel = Grid<PlaneIndex>(kWidth, kHeight)};
  for (std::size_t i = 0; i < refined.plane_of_pixel.size(); ++i)
    refined.plane_of_pixel.values()[i] = static_cast<PlaneIndex>(i / 5 % 4);
  AddArtifact("refined_view", "four-planes", EncodeRefinedView(refined), seeds);

  ConfidenceMap map{Grid<std::uint16_t>(kWidth, kHeight)};
  for (std::size_t i = 0; i < map.codes.size(); ++i) map.codes.values()[i] = static_cast<std::uint16_t>(i * 301);
  AddArtifact("confidence_map", "ramp", EncodeConfidence(map), seeds);

  std::string frame(1, '\x04');
  AppendZstdFrame("a content that repeats, a content that repeats", frame);
  seeds["zstd_frame/text"] = frame;
  seeds["file_bundle/two"] = EncodeFileBundle({{"depth/a/0000.png", "depth"}, {"confidence/a/0000.png", ""}});
  const CommittedFrame committed{.files = {{Digest(1), 100}, {Digest(2), 1}},
                                 .picture_digests = {Digest(3), Digest(4)}};
  seeds["journal_frame/written"] = EncodeFrame(committed);
  CommittedFrame kept = committed;
  kept.bundle = ArtifactInfo{Digest(5), 1000, Digest(6)};
  seeds["journal_frame/kept"] = EncodeFrame(kept);
}

void AddPictures(Seeds& seeds) {
  Grid<std::uint8_t> grey(kWidth, kHeight);
  Grid<std::uint16_t> codes(2 * kWidth, 2 * kHeight);
  Grid<float> depth(12, 9);
  for (std::size_t i = 0; i < grey.size(); ++i) grey.values()[i] = static_cast<std::uint8_t>(i);
  for (std::size_t i = 0; i < codes.size(); ++i) codes.values()[i] = static_cast<std::uint16_t>(i * 85);
  for (std::size_t i = 0; i < depth.size(); ++i) depth.values()[i] = static_cast<float>(i) / 10;
  seeds["image_file/grey.png"] = EncodeGreyPng(grey).value();
  seeds["image_file/codes.png"] = EncodeDepthPng(codes).value();
  seeds["image_file/small.ppm"] = "P6 16 12 255\n" + std::string(std::size_t{3} * kWidth * kHeight, '\x7b');
  seeds["image_file/small.pgm"] = "P5 16 12 65535\n" + std::string(std::size_t{2} * kWidth * kHeight, '\x7b');
  seeds["pfm/little"] = EncodePfm(depth);
  seeds["exr/depth"] = EncodeExr(depth).value();
  seeds["pfm/big"] = "Pf\n4 3\n1.0\n" + std::string(std::size_t{4} * 12, '\x3f');
  // Format, width - 1, height - 1 and downscale of the target, then samples.
  const std::string size = {kWidth - 1, kHeight - 1};
  seeds["raw_picture/420-8"] = "\x01" + size + "\x01" + EncodeLimitedYuv420(SmallPicture());
  seeds["raw_picture/420-10-repeated"] = "\xa7" + size + "\x02" + std::string("\x12\x02\x40\x01", 4);
  seeds["raw_picture/400-16-repeated"] = "\xf2" + size + "\x04" + std::string("\x12\xf2\x40", 3);
}

DepthManifest SmallManifest(const Sequence& sequence) {
  DepthManifest manifest;
  manifest.sequence = "two";
  manifest.algorithm_version = 9;
  manifest.first_frame = 3;
  manifest.parameters = {{"levels", std::int64_t{64}}, {"smoothing", 0.5}, {"partition", "blocks"}};
  for (const SequenceCamera& camera : sequence.cameras) {
    DepthManifestCamera& entry = manifest.cameras.emplace_back();
    entry.camera = camera.camera;
    entry.z_near = 1.5;
    entry.z_far = 9;
    entry.files = {{DepthFileName(camera.camera.name, 3), std::string(64, 'a')}};
    entry.confidence = {{ConfidenceFileName(camera.camera.name, 3), std::string(64, 'b')}};
    entry.input_sha256 = {std::string(64, 'c')};
  }
  return manifest;
}

void AddTexts(const Sequence& sequence, Seeds& seeds) {
  seeds["sequence/rendered"] = std::string(kSequence) + std::string(kListedTruth);
  std::string videos = std::string(kSequence) + std::string(kListedTruth);
  for (const auto& [pictures, video] :
       {std::pair{R"("images": ["a/0.png", "a/1.png"])", R"("video": {"path": "a.mp4", "frames": 2})"},
        std::pair{R"("images": ["b/0.yuv", "b/1.yuv"], "format": "yuv420p10le")",
                  R"("video": {"path": "b.yuv", "format": "yuv420p10le", "frames": 2})"}})
    videos.replace(videos.find(pictures), std::string_view(pictures).size(), video);
  seeds["sequence/videos"] = videos;
  seeds["sequence/measured"] = std::string(kSequence) + std::string(kWordedTruth);
  seeds["cameras/two"] = kCameras;
  seeds["depth_manifest/three"] = FormatDepthManifest(SmallManifest(sequence)).value();
  seeds["output_folder/views"] = std::string(1, '\0') + std::string(kViews);
  seeds["output_folder/prior"] = std::string(1, '\1') + std::string(kPrior);
  seeds["params/many"] = kParams;
  const std::vector<std::string> words = {"etcp://host:7700",
                                          "etcp://[::1]:*",
                                          "eipc:///run/farm",
                                          "p/shared=/mnt/nas",
                                          "fframe 3 estimate block 0",
                                          "fmerge",
                                          "lone\x1b[31m line\nand \xc3\xa4 \xff",
                                          "krq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7",
                                          "tgpu"};
  for (std::size_t i = 0; i < words.size(); ++i) seeds["option_texts/word-" + std::to_string(i)] = words[i];
  const std::vector<std::string> values = {"auto", "12",     "0.5", "on",   "sparse",
                                           "all",  "shared", "a,b", "0:50", "blocks"};
  for (std::size_t option = 0; option < 40; ++option) {
    std::string& seed = seeds["option_texts/option-" + std::to_string(option)];
    seed.push_back(static_cast<char>(option));
    seed += values[option % values.size()];
  }
}

v1::SubmitJob Submission(const Sequence& sequence) {
  v1::SubmitJob submit;
  *submit.mutable_sequence() = ToProto(sequence);
  *submit.mutable_params() = ToProto(EstimationParams());
  submit.set_output_dir("/output");
  submit.set_name("two");
  submit.add_required_tags("gpu");
  return submit;
}

std::vector<VirtualPicture> SmallViews(const Sequence& sequence) {
  std::vector<VirtualPicture> views;
  for (int i = 0; i < 2; ++i) {
    VirtualPicture& view = views.emplace_back();
    view.camera = sequence.cameras[0].camera;
    view.frame = 1;
    view.sources = {"a", "b"};
    view.number = i;
  }
  return views;
}

void AddSubmissions(const Sequence& sequence, Seeds& seeds) {
  const v1::SubmitJob plain = Submission(sequence);
  seeds["submission/estimate"] = plain.SerializeAsString();
  v1::SubmitJob kept = plain;
  kept.clear_output_dir();
  kept.set_keeps_results(true);
  kept.mutable_uploads_from()->set_endpoint("tcp://host:7701");
  for (v1::SequenceCamera& camera : *kept.mutable_sequence()->mutable_cameras()) {
    for (int frame = 0; frame < camera.images_size(); ++frame) {
      *camera.mutable_uploads()->add_images() = ToProto(UploadedFile{{Digest(7), 50}, Digest(10)});
      *camera.mutable_uploads()->add_masks() = ToProto(UploadedFile{{Digest(8), 50}, Digest(11)});
    }
  }
  seeds["submission/upload"] = kept.SerializeAsString();
  v1::SubmitJob render;
  render.mutable_sequence()->set_name("two");
  render.mutable_sequence()->set_file("/two.json");
  render.set_output_dir("/output");
  *render.mutable_render()->mutable_source() = ToProto(RenderSource{"/depth", Digest(9)});
  for (const VirtualPicture& view : SmallViews(sequence)) *render.mutable_render()->add_views() = ToProto(view);
  seeds["submission/render"] = render.SerializeAsString();
}

// As colmap_model_fuzz.cc takes a model apart.
std::string ColmapSeed(bool binary, std::string_view cameras, std::string_view images, std::string_view points) {
  std::string bytes(1, binary ? '\1' : '\0');
  for (const std::string_view part : {cameras, images}) {
    bytes += static_cast<char>(part.size() & 0xFFU);
    bytes += static_cast<char>(part.size() >> 8);
    bytes += part;
  }
  return bytes.append(points);
}

void AddCalibrations(Seeds& seeds) {
  seeds["ftv_cameras/centre"] = std::string(1, '\0') + std::string(samples::kFtv);
  seeds["ftv_cameras/behind"] = std::string(1, '\1') + std::string(samples::kFtv);
  seeds["msr_cameras/two"] = samples::kMsr;
  seeds["middlebury_cameras/two"] = samples::kMiddlebury;
  seeds["miv_cameras/four"] = samples::kMiv;
  seeds["llff_cameras/two"] = samples::Llff();
  seeds["colmap_model/text"] =
      ColmapSeed(false, samples::kColmapCameras, samples::kColmapImages, samples::ColmapPoints());
  seeds["colmap_model/binary"] =
      ColmapSeed(true, samples::ColmapCamerasBinary(), samples::ColmapImagesBinary(), samples::ColmapPointsBinary());
}

TaskSpec SmallTask(TaskKind kind, const Sequence& sequence) {
  TaskSpec spec;
  spec.id = {JobId(7), 1, kind, 0, 0};
  spec.inputs = {{{Digest(1), 77, Digest(2)}, InputRole::kAnalysis, 1, {{"tcp://host:1", std::string(40, 'k')}}}};
  switch (kind) {
    case TaskKind::kAnalyse:
      spec.picture = "/a/0.png";
      spec.guides = {.mask = "/m/0.png", .prior = "", .prior_confidence = ""};
      spec.known = spec.inputs[0];
      spec.uploads = UploadedSources{{{{Digest(3), 9}, Digest(5)}, UploadedFile{{Digest(4), 9}, Digest(6)}, {}, {}},
                                     {"tcp://host:2", ""}};
      break;
    case TaskKind::kMerge:
      spec.output_key = Digest(5);
      break;
    case TaskKind::kRender:
      spec.staging = "f1-a1-l2";
      spec.views = SmallViews(sequence);
      break;
    default:
      spec.staging = "f1-a1-l2";
      spec.files = {{"depth/a/0001.png", Digest(6), 1000}};
      spec.picture_digests = {Digest(7)};
      break;
  }
  return spec;
}

void AddEnvelope(const v1::Envelope& envelope, Seeds& seeds) {
  std::string name = "envelope/" + BodyName(envelope);
  while (seeds.contains(name)) name += "-2";
  seeds[name] = SerializeEnvelope(envelope);
}

void AddWorkerMessages(const Sequence& sequence, Seeds& seeds) {
  v1::Envelope hello;
  hello.mutable_worker_hello()->set_name("host:1:2");
  hello.mutable_worker_hello()->set_artifact_endpoint("tcp://host:1");
  hello.mutable_worker_hello()->set_slots(2);
  hello.mutable_worker_hello()->add_tags("gpu");
  hello.mutable_worker_hello()->add_running_leases(4);
  *hello.mutable_worker_hello()->add_artifacts() = ToProto(ArtifactInfo{Digest(1), 5, Digest(2)});
  AddEnvelope(hello, seeds);
  v1::Envelope finished;
  v1::TaskFinished& result = *finished.mutable_task_finished();
  result.set_lease_id(4);
  *result.mutable_task() = ToProto(TaskId{JobId(7), 1, TaskKind::kEmit, 0, 0});
  *result.mutable_artifact() = ToProto(ArtifactInfo{Digest(1), 5, Digest(2)});
  *result.add_files() = ToProto(OutputFile{"depth/a/0001.png", Digest(3), 10});
  *result.mutable_stats() = ToProto(TaskStats{.wall_seconds = 1.5, .cpu_seconds = 1, .sweeps = 3, .energy = -5});
  *result.mutable_log() = ToProto(TaskLog{.lines = {"one", "two"}, .left_out = 3});
  result.add_missing_inputs(DigestBytes(Digest(4)));
  AddEnvelope(finished, seeds);
  v1::Envelope release;
  release.mutable_release_artifacts()->add_keys(DigestBytes(Digest(1)));
  AddEnvelope(release, seeds);
  v1::Envelope keep;
  keep.mutable_keep_artifacts()->add_keys(DigestBytes(Digest(1)));
  AddEnvelope(keep, seeds);
  for (const TaskKind kind : {TaskKind::kAnalyse, TaskKind::kMerge, TaskKind::kRender, TaskKind::kCommit}) {
    v1::Envelope grant;
    grant.mutable_grant_task()->set_lease_id(4);
    *grant.mutable_grant_task()->mutable_task() = ToProto(SmallTask(kind, sequence));
    AddEnvelope(grant, seeds);
  }
}

v1::JobStatus SmallStatus() {
  v1::JobStatus status;
  status.set_job_id(7);
  status.set_name("two");
  status.set_state(v1::JOB_STATE_RUNNING);
  status.set_frames_total(10);
  status.set_frames_done(3);
  status.set_seconds_left(100);
  status.add_running("merge frame 3 round 0 pair 1 on host");
  v1::StageStatus& stage = *status.add_stages();
  stage.set_kind(v1::TASK_KIND_MERGE);
  stage.set_tasks_done(3);
  stage.set_tasks_total(9);
  stage.set_cpu_seconds(12.5);
  stage.set_left_aside(2);
  *stage.mutable_first_left_aside() = ToProto(TaskId{JobId(7), 4, TaskKind::kMerge, 0, 1});
  *status.mutable_error() = ToProto(Corrupt("a reason"));
  return status;
}

void AddClientMessages(const Sequence& sequence, Seeds& seeds) {
  v1::Envelope submit;
  *submit.mutable_submit_job() = Submission(sequence);
  AddEnvelope(submit, seeds);
  const JobConfig config = PlanSubmission(Submission(sequence), JobId(7)).value().config;
  v1::Envelope grant;
  *grant.mutable_grant_task()->mutable_job() = ToProto(config);
  *grant.mutable_grant_task()->mutable_task() = ToProto(SmallTask(TaskKind::kMerge, sequence));
  AddEnvelope(grant, seeds);
  v1::Envelope results;
  *results.mutable_results()->mutable_job() = ToProto(config);
  *results.mutable_results()->add_frames() = ToProto(FrameResult{.frame = 1,
                                                                 .bundle = {Digest(1), 5, Digest(2)},
                                                                 .locations = {{"tcp://host:1", ""}},
                                                                 .files = {{Digest(3), 9}},
                                                                 .picture_digests = {Digest(4)}});
  AddEnvelope(results, seeds);
  v1::Envelope status;
  *status.mutable_job_status() = SmallStatus();
  AddEnvelope(status, seeds);
  v1::Envelope list;
  *list.mutable_job_list()->add_jobs() = SmallStatus();
  AddEnvelope(list, seeds);
  v1::Envelope workers;
  v1::WorkerStatus& worker = *workers.mutable_worker_list()->add_workers();
  worker.set_name("host:1:2");
  worker.set_seconds_since_heard(0.5);
  worker.add_tags("gpu");
  AddEnvelope(workers, seeds);
  v1::Envelope logs;
  v1::TaskAttempt& attempt = *logs.mutable_job_logs()->add_attempts();
  *attempt.mutable_task() = ToProto(TaskId{JobId(7), 1, TaskKind::kEstimate, 0, 0});
  attempt.set_outcome(v1::ATTEMPT_OUTCOME_FAILED);
  *attempt.mutable_error() = ToProto(Unavailable("a reason"));
  *attempt.mutable_log() = ToProto(TaskLog{.lines = {"one"}, .left_out = 3});
  AddEnvelope(logs, seeds);
  v1::Envelope asked;
  asked.mutable_get_job_logs()->set_task("frame 3 estimate block 0");
  AddEnvelope(asked, seeds);
  v1::Envelope error;
  *error.mutable_error() = ToProto(InvalidArgument("a reason"));
  AddEnvelope(error, seeds);
}

// Four frames of 16x16 pixels each.
void AddVideos(Seeds& seeds) {
  const std::vector<std::pair<const char*, test::VideoRecipe>> videos = {
      {"h264.mp4", {.b_frames = 1}},
      {"mpeg2.ts", {.encoder = "mpeg2video"}},
      {"ffv1.mkv", {.encoder = "ffv1", .samples = AV_PIX_FMT_YUV422P10}},
      {"mjpeg.mkv", {.encoder = "mjpeg", .samples = AV_PIX_FMT_YUVJ420P}},
      {"raw.y4m", {.encoder = "wrapped_avframe"}}};
  const testing_support::TemporaryFolder folder;
  for (auto [name, recipe] : videos) {
    recipe.width = recipe.height = 16;
    recipe.frames = 4;
    test::WriteVideo(recipe, folder.File(name));
    seeds[std::string("video/") + name] = ReadFileBytes(folder.File(name), 1 << 20).value();
  }
}

Seeds AllSeeds() {
  Seeds seeds;
  const Sequence sequence =
      ParseSequence(std::string(kSequence) + std::string(kListedTruth), "/sequences/two.json").value();
  AddArtifacts(seeds);
  AddPictures(seeds);
  AddVideos(seeds);
  AddTexts(sequence, seeds);
  AddCalibrations(seeds);
  AddSubmissions(sequence, seeds);
  AddWorkerMessages(sequence, seeds);
  AddClientMessages(sequence, seeds);
  return seeds;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s CORPUS-FOLDER\n", argv[0]);
    return 2;
  }
  for (const auto& [name, bytes] : AllSeeds()) {
    std::string path = std::string(argv[1]) + "/" + name;
    path.insert(path.rfind('/') + 1, "seed-");
    Status written = MakeDirectories(path.substr(0, path.rfind('/')));
    if (written.ok()) written = WriteFileAtomically(path, bytes);
    if (!written.ok()) {
      std::fprintf(stderr, "%s\n", written.message().c_str());
      return 1;
    }
  }
  return 0;
}
