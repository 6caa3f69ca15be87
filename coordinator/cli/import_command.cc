#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/importing/import_sequence.h"

namespace depthfarm {
namespace {

struct Counts {
  std::ptrdiff_t with_pictures = 0;
  std::size_t frames = 0;
};

Counts CountPictures(const Sequence& sequence) {
  Counts counts;
  for (const SequenceCamera& camera : sequence.cameras) {
    if (camera.images.empty()) continue;
    ++counts.with_pictures;
    counts.frames = camera.images.size();
  }
  return counts;
}

void Print(const ImportedSequence& imported) {
  const Sequence& sequence = imported.sequence;
  const Counts counts = CountPictures(sequence);
  const Camera& reference = imported.reference;
  std::cout << sequence.file << ": " << sequence.cameras.size() << " cameras, " << counts.with_pictures
            << " of them with pictures, " << counts.frames << (counts.frames == 1 ? " frame\n" : " frames\n")
            << "reference " << reference.name << ", " << reference.width << "x" << reference.height << ", focal length "
            << reference.intrinsics(0, 0) << " px, depth " << imported.range.z_near << " to " << imported.range.z_far
            << "\n";
  if (!imported.array.nearest.empty()) {
    std::cout << "baseline to " << imported.array.nearest << ", the nearest: " << imported.array.baseline
              << ", disparity about " << imported.array.disparity_far << " to " << imported.array.disparity_near
              << " px\n";
  }
  if (counts.with_pictures < 2) {
    std::cout << "note: depth is estimated for two or more cameras with pictures (--images)\n";
  }
  for (const std::string& name : imported.array.lonely) {
    std::cout << "note: camera " << name
              << " sees the scene as no other does: leave it out (--cameras here, --views of "
              << "run), or check the depth range\n";
  }
}

nlohmann::ordered_json ToJson(const ImportedSequence& imported) {
  const Counts counts = CountPictures(imported.sequence);
  return {{"sequence", imported.sequence.file},
          {"cameras", imported.sequence.cameras.size()},
          {"camerasWithPictures", counts.with_pictures},
          {"frames", counts.frames},
          {"reference", imported.reference.name},
          {"width", imported.reference.width},
          {"height", imported.reference.height},
          {"zNear", imported.range.z_near},
          {"zFar", imported.range.z_far},
          {"nearestCamera", imported.array.nearest},
          {"baseline", imported.array.baseline},
          {"disparityNear", imported.array.disparity_near},
          {"disparityFar", imported.array.disparity_far},
          {"lonelyCameras", imported.array.lonely}};
}

}  // namespace

int Execute(const ImportArguments& arguments) {
  const Result<ImportedSequence> imported = ImportSequence(arguments.options);
  if (!imported.ok()) return Fail(imported.status());
  if (arguments.json) {
    std::cout << ToJson(*imported).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  } else {
    Print(*imported);
  }
  return kExitOk;
}

}  // namespace depthfarm
