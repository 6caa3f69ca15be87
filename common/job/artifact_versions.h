#ifndef DEPTHFARM_COMMON_JOB_ARTIFACT_VERSIONS_H_
#define DEPTHFARM_COMMON_JOB_ARTIFACT_VERSIONS_H_

#include <cstdint>

namespace depthfarm {

// Versions of the bytes of artifacts whose form has changed without their content. Names of artifacts hold them beside
// the algorithm version: one of an older form, kept by some worker, is not found and refused, but another artifact.
inline constexpr std::uint32_t kViewAnalysisVersion = 3;  // worker/segmentation/analysis_codec.h
inline constexpr std::uint32_t kRefinedViewVersion = 2;   // worker/refinement/refined_view_codec.h

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_JOB_ARTIFACT_VERSIONS_H_
