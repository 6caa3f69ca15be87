#include <vector>

#include "common/files/path_map.h"
#include "common/text/clean_line.h"
#include "common/transport/endpoint.h"
#include "common/transport/keys.h"
#include "common/wire/bounds.h"
#include "coordinator/cli/estimation_options.h"
#include "coordinator/service/task_filter.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace depthfarm;

void TryEndpoint(std::string_view text) {
  const auto endpoint = ParseEndpoint(text);
  if (!endpoint.ok()) return;
  ++fuzz::accepted;
  (void)endpoint->IsLoopback();
  const auto again = ParseEndpoint(endpoint->ToString());
  fuzz::Require(again.ok() && again->ToString() == endpoint->ToString(), "an endpoint comes back");
}

void TryPathMap(const std::string& text) {
  const auto map = PathMap::Parse({text});
  if (!map.ok()) return;
  ++fuzz::accepted;
  (void)map->Map(text);
  (void)map->Explain(Unavailable(text));
}

void TryCleanLine(std::string_view text) {
  constexpr std::size_t kMost = 100;
  const std::string line = CleanLine(text, kMost);
  fuzz::Require(line.size() <= kMost && CleanLine(line, kMost) == line, "a clean line is clean and short");
}

void TryEstimationOption(unsigned which, std::string_view text) {
  EstimationParams params;
  const auto options = EstimationOptions();
  if (!options[which % options.size()].apply(text, params).ok()) return;
  ++fuzz::accepted;
  (void)params.Validate();
}

}  // namespace

// Words of command lines, and of messages and keys that are words too: the first byte says which.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text = fuzz::Text(data, size);
  switch (const unsigned kind = fuzz::TakeByte(text)) {
    case 'e':
      TryEndpoint(text);
      break;
    case 'p':
      TryPathMap(std::string(text));
      break;
    case 'f':
      if (const auto filter = TaskFilter::Parse(text); filter.ok()) (void)filter->Matches(TaskId());
      break;
    case 'l':
      TryCleanLine(text);
      break;
    case 'k':
      (void)IsCurveKey(text);
      break;
    case 't':
      (void)CheckTags("tags", {std::string(text)});
      break;
    default:
      TryEstimationOption(kind, text);
  }
  return 0;
}
