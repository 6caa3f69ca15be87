#ifndef DEPTHFARM_COORDINATOR_ENGINES_COMMAND_H_
#define DEPTHFARM_COORDINATOR_ENGINES_COMMAND_H_

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// What a program wrote, at most kMostCommandOutput of each.
struct CommandOutput {
  int exit_code = 0;
  std::string output;
  std::string error;
};

inline constexpr std::size_t kMostCommandOutput = std::size_t{16} << 20;

// Whether who waits for a command wants to leave: asked a few times a second. Empty: never.
using InHurry = std::function<bool()>;

// How long a command may take.
struct CommandLimit {
  std::chrono::milliseconds usual{};
  InHurry in_hurry = {};
  std::chrono::milliseconds hurried{3000};  // from its start, or from when the hurry began
};

// Runs a program that is found in PATH, without a shell, with `input` on its stdin, and waits for its end.
// Errors  kUnavailable: there is no such program, it was killed by a signal, took longer than `limit` (it is killed
//         then) or wrote more than kMostCommandOutput. An exit code other than 0 is no error here.
[[nodiscard]] Result<CommandOutput> RunCommand(const std::vector<std::string>& words, std::string_view input,
                                               const CommandLimit& limit);

// The word as a POSIX shell takes it back, quoted if need be.
[[nodiscard]] std::string ShellQuoted(std::string_view word);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_ENGINES_COMMAND_H_
