#include "tests/worker/media_cli/evaluated_scene.h"

#include <nlohmann/json.hpp>

#include "common/geometry/depth_levels.h"
#include "common/media/depth_file.h"
#include "common/media/grey_picture.h"
#include "common/media/pfm.h"
#include "common/scene/array.h"
#include "common/scene/render.h"
#include "common/scene/scene.h"
#include "common/sequence/depth_manifest.h"

namespace depthfarm {
namespace {

constexpr int kFrames = 2;
constexpr int kLevels = 100;

nlohmann::json Rows(const Eigen::Matrix3d& m) {
  nlohmann::json rows = nlohmann::json::array();
  for (int row = 0; row < 3; ++row) rows.push_back({m(row, 0), m(row, 1), m(row, 2)});
  return rows;
}

std::string LumaPlane(const YcbcrImage& picture) {
  std::string bytes;
  for (const Ycbcr& pixel : picture.values()) bytes.push_back(static_cast<char>(pixel.y));
  return bytes;
}

}  // namespace

EvaluatedScene::EvaluatedScene() : cameras_(MakeArray(ArrayKind::kArc, 4, 160, 120, 1)) {
  const Scene scene = MakeScene(1);
  const DepthRange range = SceneDepthRange(scene, cameras_, cameras_[1], kFrames).value();
  z_near_ = range.z_near;
  z_far_ = range.z_far;
  nlohmann::json cameras = nlohmann::json::array();
  nlohmann::json truths = nlohmann::json::array();
  for (const Camera& camera : cameras_) {
    nlohmann::json images = nlohmann::json::array();
    nlohmann::json depths = nlohmann::json::array();
    nlohmann::json zones = nlohmann::json::array();
    exact_.emplace_back();
    for (int frame = 0; frame < kFrames; ++frame) {
      const RenderedView view = RenderView(scene, camera, frame, {.noise = 1.5, .gain = 0});
      const std::string stem = camera.name + "/" + std::to_string(frame);
      folder_.Write(stem + ".yuv", LumaPlane(ToYcbcr(view.rgb)));
      folder_.Write(stem + ".pfm", EncodePfm(view.depth));
      folder_.Write(stem + "_zones.png", EncodeGreyPng(view.zones).value());
      images.push_back(stem + ".yuv");
      depths.push_back(stem + ".pfm");
      zones.push_back(stem + "_zones.png");
      exact_.back().push_back(view.depth);
    }
    const Eigen::Vector3d& t = camera.cam_from_world_translation;
    cameras.push_back({{"name", camera.name},
                       {"width", camera.width},
                       {"height", camera.height},
                       {"K", Rows(camera.intrinsics)},
                       {"R", Rows(camera.cam_from_world_rotation)},
                       {"t", {t[0], t[1], t[2]}},
                       {"format", "gray8"},
                       {"range", "full"},
                       {"images", images}});
    truths.push_back({{"view", camera.name}, {"depth", depths}, {"zones", zones}});
  }
  const nlohmann::json sequence = {
      {"name", "arc"},
      {"convention", "x_cam = R*X_world + t, +z forward, +y down, pixels (0,0)=centre of top-left pixel"},
      {"zNear", z_near_},
      {"zFar", z_far_},
      {"reference", cameras_[1].name},
      {"cameras", cameras},
      {"groundTruth", {{"encoding", "z-pfm"}, {"views", truths}}}};
  folder_.Write("sequence.json", sequence.dump());
}

std::string EvaluatedScene::WriteDepth(const std::string& name, const Estimate& estimate,
                                       const std::set<std::string>& views, const Confidence& confidence) const {
  DepthManifest manifest;
  manifest.sequence = "arc";
  manifest.algorithm_version = 1;
  manifest.parameters = {{"levels", std::int64_t{kLevels}}};
  const DepthLevels levels = DepthLevels::Create(cameras_[1], z_near_, z_far_, kLevels).value();
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    if (!views.empty() && !views.contains(cameras_[i].name)) continue;
    const DepthRange own = OwnDepthRange(cameras_[i], levels).value();
    const DepthCode code = DepthCode::Create(own.z_near, own.z_far).value();
    DepthManifestCamera camera;
    camera.camera = cameras_[i];
    camera.z_near = own.z_near;
    camera.z_far = own.z_far;
    for (int frame = 0; frame < kFrames; ++frame) {
      DepthMap depth = exact_[i][static_cast<std::size_t>(frame)];
      estimate(depth);
      const std::string path = DepthFileName(cameras_[i].name, frame);
      folder_.Write(name + "/" + path, EncodeDepthPng(depth, code).value());
      camera.files.push_back({path, std::string(64, '0')});
      camera.input_sha256.emplace_back(64, '0');
      if (!confidence) continue;
      Grid<std::uint16_t> codes(depth.width(), depth.height());
      for (int y = 0; y < codes.height(); ++y)
        for (int x = 0; x < codes.width(); ++x) codes(x, y) = confidence(x);
      const std::string confidence_path = ConfidenceFileName(cameras_[i].name, frame);
      folder_.Write(name + "/" + confidence_path, EncodeDepthPng(codes).value());
      camera.confidence.push_back({confidence_path, std::string(64, '0')});
    }
    manifest.cameras.push_back(camera);
  }
  folder_.Write(name + "/depth.json", FormatDepthManifest(manifest).value());
  return folder_.File(name);
}

}  // namespace depthfarm
