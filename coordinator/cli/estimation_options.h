#ifndef DEPTHFARM_COORDINATOR_CLI_ESTIMATION_OPTIONS_H_
#define DEPTHFARM_COORDINATOR_CLI_ESTIMATION_OPTIONS_H_

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/status.h"
#include "common/job/estimation_params.h"

namespace depthfarm {

// One estimation option: the same name on the command line ("--" + name), in a params file and in error messages.
struct EstimationOption {
  std::string_view name;
  std::string_view value;  // what the help calls its value, e.g. "auto|N"
  std::string_view help;   // meaning, unit, default
  // Sets it from the text a user wrote; kInvalidArgument names the option, the text and what was expected. Bounds that
  // EstimationParams::Validate checks are left to it.
  Status (*apply)(std::string_view text, EstimationParams& params);
};

// All of them in the order of the help. Preset and params file are not among them: they come before.
[[nodiscard]] std::span<const EstimationOption> EstimationOptions();

// What the command line said about the estimation, in the words it used.
struct EstimationArguments {
  std::string preset;                                       // empty: the params file's, else "default"
  std::string params_file;                                  // empty: none
  std::vector<std::pair<std::string, std::string>> values;  // explicit options: name, text
  bool operator==(const EstimationArguments&) const = default;
};

// Preset, then params file, then explicit options; validated. Reads the params file.
// Errors (kInvalidArgument): an unreadable file or one that breaks the rules of ApplyParamsJson, a value out of bounds.
[[nodiscard]] Result<EstimationParams> BuildEstimationParams(const EstimationArguments& arguments);

// Params from the text of a params file: one JSON object of option names, e.g. {"preset": "paper", "levels": 64,
// "views": ["cam0", "cam1"], "segments": "auto"}. Its "preset" counts unless `preset` is not empty. Unknown or repeated
// keys and values of the wrong type are errors (kInvalidArgument) that name `file` and key. Not yet validated.
[[nodiscard]] Result<EstimationParams> ParseParamsJson(std::string_view text, const std::string& file,
                                                       const std::string& preset);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_ESTIMATION_OPTIONS_H_
