#include "coordinator/service/task_filter.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>
#include <vector>

#include "coordinator/planning/job_plan.h"

namespace depthfarm {
namespace {

constexpr std::size_t kLongestText = 200;
constexpr std::array<std::string_view, 6> kNumbered{"job", "frame", "part", "view", "block", "round"};

bool IsNumbered(std::string_view word) {
  return word == "pair" || std::ranges::find(kNumbered, word) != kNumbered.end();
}

bool IsNumber(std::string_view word) {
  return !word.empty() && std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
}

bool IsKind(std::string_view word) {
  for (int kind = 0; kind < kNumTaskKinds; ++kind)
    if (word == TaskKindName(static_cast<TaskKind>(kind))) return true;
  return false;
}

// "frame 3 estimate block 0": {"frame 3", "estimate", "block 0"}.
std::set<std::string> PartsOf(std::string_view name) {
  std::istringstream words{std::string(name)};
  std::vector<std::string> parts;
  for (std::string word; words >> word;) {
    if (IsNumber(word) && !parts.empty()) {
      parts.back() += " " + word;
    } else {
      parts.push_back(word);
    }
  }
  return {parts.begin(), parts.end()};
}

}  // namespace

Result<TaskFilter> TaskFilter::Parse(std::string_view text) {
  TaskFilter filter;
  if (text.size() <= kLongestText) filter.parts_ = PartsOf(text);
  const bool legal = text.size() <= kLongestText && std::ranges::all_of(filter.parts_, [](const std::string& part) {
                       const std::size_t space = part.find(' ');
                       if (space == std::string::npos) return IsKind(part);
                       return IsNumbered(part.substr(0, space)) && IsNumber(part.substr(space + 1));
                     });
  if (legal) return filter;
  return InvalidArgument("no task is named '" + std::string(text.substr(0, kLongestText)) +
                         "': name it as status does, e.g. 'frame 3 estimate block 0', or a part of that, e.g. 'frame "
                         "3' or 'merge'");
}

bool TaskFilter::Matches(const TaskId& task) const {
  if (parts_.empty()) return true;
  return std::ranges::includes(PartsOf(TaskName(task)), parts_);
}

}  // namespace depthfarm
