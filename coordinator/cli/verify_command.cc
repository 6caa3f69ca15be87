#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/sequence/output_check.h"
#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/report.h"

namespace depthfarm {
namespace {

constexpr std::size_t kMostNamed = 20;  // of each kind: thousands would hide the rest; --json has them all

void PrintFiles(const char* what, const std::vector<std::string>& paths) {
  for (std::size_t i = 0; i < std::min(paths.size(), kMostNamed); ++i) std::cout << what << "  " << paths[i] << "\n";
  if (paths.size() > kMostNamed) std::cout << what << "  and " << paths.size() - kMostNamed << " more\n";
}

void Print(const OutputCheck& check) {
  PrintFiles("missing   ", check.missing);
  PrintFiles("unreadable", check.unreadable);
  PrintFiles("changed   ", check.changed);
  PrintFiles("unlisted  ", check.unlisted);
  std::string manifests;
  for (const std::string& name : check.manifests) manifests += (manifests.empty() ? "" : " and ") + name;
  const std::size_t right = check.files - check.missing.size() - check.unreadable.size() - check.changed.size();
  std::cout << right << " of " << check.files << " files of " << manifests << " are right ("
            << FormatBytes(static_cast<double>(check.bytes)) << ")\n";
  if (!check.unlisted.empty()) std::cout << "unlisted files are of another job or by hand\n";
  if (check.unfinished) std::cout << "a job owns the folder: it runs, or ended before it was done\n";
}

nlohmann::ordered_json ToJson(const OutputCheck& check) {
  return {{"good", check.good()},     {"manifests", check.manifests}, {"files", check.files},
          {"bytes", check.bytes},     {"missing", check.missing},     {"unreadable", check.unreadable},
          {"changed", check.changed}, {"unlisted", check.unlisted},   {"unfinished", check.unfinished}};
}

}  // namespace

int Execute(const VerifyArguments& arguments) {
  CatchInterruptions();
  const Result<OutputCheck> check = CheckOutput(arguments.directory, Interrupted);
  if (!check.ok()) return Fail(check.status());
  if (arguments.json) {
    std::cout << ToJson(*check).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  } else {
    Print(*check);
  }
  return check->good() ? kExitOk : kExitFailed;
}

}  // namespace depthfarm
