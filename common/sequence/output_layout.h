#ifndef DEPTHFARM_COMMON_SEQUENCE_OUTPUT_LAYOUT_H_
#define DEPTHFARM_COMMON_SEQUENCE_OUTPUT_LAYOUT_H_

#include <string>

namespace depthfarm {

// What an output folder has, by name.
inline constexpr const char* kDepthManifestName = "depth.json";
inline constexpr const char* kViewsManifestName = "views.json";  // the same of virtual views
// Where committed files are, whose paths begin with these.
inline constexpr const char* kDepthFolder = "depth";
inline constexpr const char* kConfidenceFolder = "confidence";
inline constexpr const char* kViewsFolder = "views";
// Files of attempts that are not committed yet.
inline constexpr const char* kStagingFolder = ".depthfarm-staging";
// There while a job owns the folder, or ended without giving it up.
inline constexpr const char* kDepthJobMarker = ".depthfarm-job";
inline constexpr const char* kViewsJobMarker = ".depthfarm-views-job";

// Whether a path that a manifest names is relative and of plain names, so that it leads to a file below the folder.
[[nodiscard]] bool StaysInFolder(const std::string& path);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_OUTPUT_LAYOUT_H_
