#include "coordinator/cli/media_program.h"

#include <chrono>
#include <optional>

#include "coordinator/cli/interruption.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kLookInterval{100};
constexpr std::chrono::milliseconds kStopGrace{2000};

}  // namespace

Result<ProcessEnd> RunMedia(const std::vector<std::string>& words, const std::filesystem::path& output) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::filesystem::path program, SiblingProgram("depthfarm-media"));
  DEPTHFARM_ASSIGN_OR_RETURN(ChildProcess child, ChildProcess::Start(program, words, output));
  std::optional<ProcessEnd> end;
  while (!(end = child.WaitFor(kLookInterval))) {
    if (!Interrupted()) continue;
    child.Stop(kStopGrace);
    return Cancelled();
  }
  return *end;
}

}  // namespace depthfarm
