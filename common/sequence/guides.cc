#include "common/sequence/guides.h"

#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "common/files/atomic_file.h"
#include "common/sequence/depth_format.h"
#include "common/sequence/depth_manifest.h"
#include "common/sequence/frame_name.h"
#include "common/sequence/json_fields.h"
#include "common/sequence/output_layout.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDescription = "prior.json";
constexpr std::uint64_t kMaxDescriptionBytes = std::uint64_t{1} << 20;

// The folder as a path that stays right wherever the program runs.
Result<fs::path> Folder(const std::string& what, const std::string& directory) {
  std::error_code error;
  const fs::path absolute = fs::absolute(directory, error).lexically_normal();
  if (directory.empty() || error || !fs::is_directory(absolute, error))
    return InvalidArgument(what + " folder '" + directory + "' is no folder");
  return absolute;
}

// The path if there is such a file, else "".
std::string IfThere(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) ? file.string() : "";
}

std::string CameraNames(const Sequence& sequence) {
  constexpr std::size_t kMost = 4;
  std::string names;
  for (std::size_t i = 0; i < sequence.cameras.size() && i < kMost; ++i)
    names += (i == 0 ? "" : ", ") + sequence.cameras[i].camera.name;
  return names + (sequence.cameras.size() > kMost ? ", ..." : "");
}

// Files of an output folder are of one format (DepthFormat).
PriorFormat FormatOf(const DepthManifestCamera& entry) {
  const auto format = entry.files.empty() ? std::nullopt : DepthFormatOfFile(entry.files.front().path);
  if (format == DepthFormat::kPfm || format == DepthFormat::kExr) return {.holds = PriorFormat::Holds::kDepth};
  return {.holds = PriorFormat::Holds::kCodes, .z_near = entry.z_near, .z_far = entry.z_far};
}

Status AddFromManifest(const fs::path& folder, Sequence& sequence) {
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthManifest manifest, ReadDepthManifest(folder.string()));
  for (SequenceCamera& camera : sequence.cameras) {
    camera.prior.assign(camera.images.size(), "");
    camera.prior_confidence.assign(camera.images.size(), "");
    for (const DepthManifestCamera& entry : manifest.cameras) {
      if (entry.camera.name != camera.camera.name) continue;
      camera.prior_format = FormatOf(entry);
      for (std::size_t i = 0; i < entry.files.size(); ++i) {
        const std::size_t frame = static_cast<std::size_t>(manifest.first_frame) + i;
        if (frame >= camera.images.size()) break;
        camera.prior[frame] = IfThere(folder / entry.files[i].path);
        if (!entry.confidence.empty()) camera.prior_confidence[frame] = IfThere(folder / entry.confidence[i].path);
      }
    }
  }
  return {};
}

struct Description {
  PriorFormat format;
  bool still = false;
};

Result<Description> ReadDescription(const std::string& file) {
  static constexpr std::array<std::string_view, 4> kKeys = {"holds", "unit", "still", "notes"};
  const auto text = ReadFileBytes(file, kMaxDescriptionBytes);
  if (!text.ok()) return InvalidArgument("prior " + text.status().message());
  const auto document = ParseStrictJson(*text);
  if (!document.ok()) return document.status().WithContext(file);
  DEPTHFARM_ASSIGN_OR_RETURN(const JsonFields fields, JsonFields::Of(*document, file, kKeys));
  Description description;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string holds, fields.String("holds"));
  if (holds == "depth") {
    description.format.holds = PriorFormat::Holds::kDepth;
  } else if (holds == "inverse-depth") {
    description.format.holds = PriorFormat::Holds::kInverseDepth;
  } else if (holds == "relative-depth") {
    description.format.holds = PriorFormat::Holds::kRelativeDepth;
  } else {
    return fields.Bad("'holds' is " + Shortened(Json(holds)) + ", expected depth, inverse-depth or relative-depth");
  }
  if (fields.Has("unit")) {
    if (holds == "relative-depth") return fields.Bad("'unit' is given, but relative-depth has none");
    DEPTHFARM_ASSIGN_OR_RETURN(description.format.unit, fields.Positive("unit"));
  }
  if (fields.Has("still")) {
    DEPTHFARM_ASSIGN_OR_RETURN(const Json* still, fields.Value("still"));
    if (!still->is_boolean()) return fields.Bad("'still' is " + Shortened(*still) + ", expected true or false");
    description.still = still->get<bool>();
  }
  if (fields.Has("notes")) DEPTHFARM_RETURN_IF_ERROR(fields.String("notes").status());
  return description;
}

Status AddDescribed(const fs::path& folder, Sequence& sequence) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Description description, ReadDescription((folder / kDescription).string()));
  for (SequenceCamera& camera : sequence.cameras) {
    camera.prior_format = description.format;
    camera.prior.assign(camera.images.size(), "");
    camera.prior_confidence.assign(camera.images.size(), "");
    for (std::size_t frame = 0; frame < camera.images.size(); ++frame) {
      if (description.still && frame > 0) {
        camera.prior[frame] = camera.prior[0];
        camera.prior_confidence[frame] = camera.prior_confidence[0];
        continue;
      }
      const std::string name = camera.camera.name + "/" + FrameName(static_cast<int>(frame));
      for (const char* extension : {".pfm", ".exr", ".png"}) {
        if (camera.prior[frame].empty()) camera.prior[frame] = IfThere(folder / kDepthFolder / (name + extension));
      }
      camera.prior_confidence[frame] = IfThere(folder / kConfidenceFolder / (name + ".png"));
    }
  }
  return {};
}

}  // namespace

Status AddPriors(const std::string& directory, Sequence& sequence) {
  DEPTHFARM_ASSIGN_OR_RETURN(const fs::path folder, Folder("prior", directory));
  if (!IfThere(folder / kDepthManifestName).empty()) {
    DEPTHFARM_RETURN_IF_ERROR(AddFromManifest(folder, sequence));
  } else if (!IfThere(folder / kDescription).empty()) {
    DEPTHFARM_RETURN_IF_ERROR(AddDescribed(folder, sequence));
  } else {
    return InvalidArgument("prior folder " + folder.string() +
                           " has neither depth.json (an output folder) nor prior.json (see README, Priors and masks)");
  }
  bool any = false;
  for (SequenceCamera& camera : sequence.cameras) {
    if (AnyFile(camera.prior)) {
      any = true;
    } else {
      camera.prior_format = {};
      camera.prior.clear();
      camera.prior_confidence.clear();
    }
  }
  if (any) return {};
  return InvalidArgument("prior folder " + folder.string() + " has no depth of any camera of the sequence (" +
                         CameraNames(sequence) + "): expected files such as depth/" +
                         sequence.cameras.front().camera.name + "/0000.pfm");
}

Status AddMasks(const std::string& directory, Sequence& sequence) {
  DEPTHFARM_ASSIGN_OR_RETURN(const fs::path folder, Folder("mask", directory));
  bool any = false;
  for (SequenceCamera& camera : sequence.cameras) {
    camera.masks.assign(camera.images.size(), "");
    for (std::size_t frame = 0; frame < camera.images.size(); ++frame)
      camera.masks[frame] = IfThere(folder / camera.camera.name / (FrameName(static_cast<int>(frame)) + ".png"));
    any = any || AnyFile(camera.masks);
  }
  if (any) return {};
  return InvalidArgument("mask folder " + folder.string() + " has no mask of any camera of the sequence (" +
                         CameraNames(sequence) + "): expected files such as " + sequence.cameras.front().camera.name +
                         "/0000.png");
}

}  // namespace depthfarm
