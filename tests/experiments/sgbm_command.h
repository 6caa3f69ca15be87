#ifndef DEPTHFARM_TESTS_EXPERIMENTS_SGBM_COMMAND_H_
#define DEPTHFARM_TESTS_EXPERIMENTS_SGBM_COMMAND_H_

#include <iosfwd>
#include <string>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

struct SgbmCommandOptions {
  std::string sequence;
  std::string output;              // made; depth.json and depth/ as `depthfarm run` writes them
  std::vector<std::string> views;  // empty: every camera that has pictures
  int first_frame = 0;
  int end_frame = -1;
  int downscale = 1;
};

// Depth of a sequence by EstimateBySgbm, each view with its two neighbours, on the same views, depth range and sizes as
// a job of `depthfarm run` has, so that `depthfarm evaluate` judges both alike. Says the CPU time a view takes.
[[nodiscard]] Status RunSgbm(const SgbmCommandOptions& options, std::ostream& out);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_EXPERIMENTS_SGBM_COMMAND_H_
