#include "worker/execution/views_manifest.h"

#include <nlohmann/json.hpp>

#include "common/digest/sha256.h"

namespace depthfarm {
namespace {

using OrderedJson = nlohmann::ordered_json;  // keeps the order of writing: the file is read by people too

OrderedJson ViewJson(const VirtualPicture& view, const OutputFile& file) {
  OrderedJson k = OrderedJson::array();
  OrderedJson r = OrderedJson::array();
  for (int row = 0; row < 3; ++row) {
    const auto& intrinsics = view.camera.intrinsics;
    const auto& rotation = view.camera.cam_from_world_rotation;
    k.push_back({intrinsics(row, 0), intrinsics(row, 1), intrinsics(row, 2)});
    r.push_back({rotation(row, 0), rotation(row, 1), rotation(row, 2)});
  }
  const Eigen::Vector3d& t = view.camera.cam_from_world_translation;
  return {{"file", file.path},
          {"sha256", Hex(file.sha256)},
          {"frame", view.frame},
          {"from", view.sources},
          {"camera", view.camera.name},
          {"width", view.camera.width},
          {"height", view.camera.height},
          {"K", std::move(k)},
          {"R", std::move(r)},
          {"t", {t[0], t[1], t[2]}}};
}

}  // namespace

Result<std::string> FormatViewsManifest(const JobConfig& config, const std::vector<VirtualPicture>& views,
                                        const std::vector<OutputFile>& files) {
  if (views.size() != files.size()) {
    return InvalidArgument("views.json: " + std::to_string(files.size()) + " files of " + std::to_string(views.size()) +
                           " views");
  }
  OrderedJson entries = OrderedJson::array();
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (files[i].path != ViewFileName(views[i].number)) {
      return InvalidArgument("views.json: file '" + files[i].path + "', expected '" + ViewFileName(views[i].number) +
                             "'");
    }
    entries.push_back(ViewJson(views[i], files[i]));
  }
  const OrderedJson document = {{"format", "depthfarm-views-1"},
                                {"sequence", config.sequence_name},
                                {"depthManifestSha256", Hex(config.render->manifest_sha256)},
                                {"views", std::move(entries)}};
  try {
    return document.dump(1) + "\n";
  } catch (const nlohmann::json::exception& error) {  // text that is not UTF-8
    return InvalidArgument(std::string("views.json cannot be written: ") + error.what());
  }
}

}  // namespace depthfarm
