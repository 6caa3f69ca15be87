#ifndef DEPTHFARM_TESTS_EXPERIMENTS_BASELINE_COMMAND_H_
#define DEPTHFARM_TESTS_EXPERIMENTS_BASELINE_COMMAND_H_

#include <functional>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/image/picture.h"
#include "common/job/estimation_params.h"
#include "common/job/resolved_job.h"
#include "common/sequence/depth_manifest.h"
#include "tests/experiments/pixel_cut.h"

namespace depthfarm {

struct BaselineCommandOptions {
  std::string sequence;
  std::string output;       // made; depth.json and depth/ as `depthfarm run` writes them
  EstimationParams params;  // those that the method has no use for change nothing
};

// The depth of all views of a frame, in the job's order; `pictures` likewise.
using FrameMethod =
    std::function<Result<std::vector<DepthMap>>(const ResolvedJob& job, const std::vector<YcbcrImage>& pictures)>;

struct BaselineMethod {
  std::string name;
  FrameMethod estimate;
  std::map<std::string, ManifestNumberOrText> parameters;  // its own, for depth.json
};

// Depth of a sequence by another method, on the same views, depth range, levels and sizes as a job of `depthfarm run`
// has, so that `depthfarm evaluate` judges both alike. Says the CPU time a view takes, reading and writing apart.
[[nodiscard]] Status RunBaseline(const BaselineCommandOptions& options, const BaselineMethod& method,
                                 std::ostream& out);

// The methods. Each view has its two neighbours, where there is one only (the end of an arc) the next nearest too.
[[nodiscard]] Result<std::vector<DepthMap>> SgbmOfFrame(const ResolvedJob& job,
                                                        const std::vector<YcbcrImage>& pictures);
[[nodiscard]] Result<std::vector<DepthMap>> PixelCutOfFrame(const ResolvedJob& job,
                                                            const std::vector<YcbcrImage>& pictures,
                                                            const PixelCutParams& params);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_EXPERIMENTS_BASELINE_COMMAND_H_
