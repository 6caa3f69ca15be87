#ifndef DEPTHFARM_TESTS_WORKER_MEDIA_CLI_EVALUATED_SCENE_H_
#define DEPTHFARM_TESTS_WORKER_MEDIA_CLI_EVALUATED_SCENE_H_

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "common/geometry/camera.h"
#include "common/image/picture.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {

// A rendered arc of four cameras, cam0 to cam3, two frames of 160 x 120, on disk with its exact depth.
class EvaluatedScene {
 public:
  EvaluatedScene();

  [[nodiscard]] std::string sequence_file() const { return folder_.File("sequence.json"); }
  [[nodiscard]] std::string File(const std::string& name) const { return folder_.File(name); }

  // Changes an exact depth map into a supposed estimate.
  using Estimate = std::function<void(DepthMap& depth)>;

  // Confidence codes of a pixel column of every map; null: none are written.
  using Confidence = std::function<std::uint16_t(int x)>;

  // Writes depth.json and the maps of `views` (all if empty) into a folder and returns it.
  [[nodiscard]] std::string WriteDepth(const std::string& name, const Estimate& estimate,
                                       const std::set<std::string>& views = {},
                                       const Confidence& confidence = nullptr) const;

 private:
  testing_support::TemporaryFolder folder_;
  std::vector<Camera> cameras_;
  std::vector<std::vector<DepthMap>> exact_;  // [camera][frame]
  double z_near_ = 0;
  double z_far_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_WORKER_MEDIA_CLI_EVALUATED_SCENE_H_
