#ifndef DEPTHFARM_COMMON_JOB_VIRTUAL_PICTURE_H_
#define DEPTHFARM_COMMON_JOB_VIRTUAL_PICTURE_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/camera.h"

namespace depthfarm {

// One picture that a rendering job makes from the pictures and depth of some views.
struct VirtualPicture {
  Camera camera;                     // from where
  int frame = 0;                     // of the sequence
  std::vector<std::string> sources;  // cameras of the sequence, at least one
  int number = 0;                    // names its file, unique in the job
  bool operator==(const VirtualPicture&) const = default;
};

// Where a rendering job's depth is. Its pictures are those of the sequence file.
struct RenderSource {
  std::string depth_dir;                           // absolute, as the submitter sees it
  std::array<std::uint8_t, 32> manifest_sha256{};  // of its depth.json: all workers render the same depth, or none
  bool operator==(const RenderSource&) const = default;
};

// "views/0012.png": the picture's file, relative to the job's output folder.
[[nodiscard]] std::string ViewFileName(int number);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_JOB_VIRTUAL_PICTURE_H_
