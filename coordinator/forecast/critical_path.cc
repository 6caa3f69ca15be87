#include "coordinator/forecast/critical_path.h"

#include <algorithm>

namespace depthfarm {

CriticalPath FindCriticalPath(const TaskGraph& graph) {
  std::vector<double> ends(graph.size());
  std::vector<TaskGraph::Index> before(graph.size());
  for (TaskGraph::Index index = 0; index < graph.size(); ++index) {
    double start = 0;
    before[index] = index;  // none
    for (const TaskGraph::Index needed : graph.Needs(index)) {
      if (before[index] != index && ends[needed] <= start) continue;
      start = ends[needed];
      before[index] = needed;
    }
    ends[index] = start + graph.cost(index).seconds;
  }
  CriticalPath path;
  if (ends.empty()) return path;
  const auto last = std::max_element(ends.begin(), ends.end());
  path.seconds = *last;
  auto index = static_cast<TaskGraph::Index>(last - ends.begin());
  for (;;) {
    path.tasks.push_back(index);
    if (before[index] == index) break;
    index = before[index];
  }
  std::reverse(path.tasks.begin(), path.tasks.end());
  return path;
}

}  // namespace depthfarm
