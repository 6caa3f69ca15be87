#include "common/job/task.h"

namespace depthfarm {

std::string TaskKindName(TaskKind kind) {
  switch (kind) {
    case TaskKind::kPrepare:
      return "prepare";
    case TaskKind::kAnalyse:
      return "analyse";
    case TaskKind::kEstimate:
      return "estimate";
    case TaskKind::kMerge:
      return "merge";
    case TaskKind::kRefine:
      return "refine";
    case TaskKind::kAssess:
      return "assess";
    case TaskKind::kRender:
      return "render";
    case TaskKind::kEmit:
      return "emit";
    case TaskKind::kCommit:
      return "commit";
    case TaskKind::kManifest:
      return "manifest";
    case TaskKind::kCleanup:
      return "cleanup";
  }
  return "unknown";
}

std::string TaskName(const TaskId& id) {
  std::string name = "job " + std::to_string(id.job.value());
  const bool of_job = id.kind == TaskKind::kPrepare || id.kind == TaskKind::kManifest || id.kind == TaskKind::kCleanup;
  if (id.kind == TaskKind::kRender) return name + " render part " + std::to_string(id.frame);
  if (!of_job) name += " frame " + std::to_string(id.frame);
  name += " " + TaskKindName(id.kind);
  if (id.kind == TaskKind::kAnalyse || id.kind == TaskKind::kAssess) name += " view " + std::to_string(id.index);
  if (id.kind == TaskKind::kEstimate) name += " block " + std::to_string(id.index);
  if (id.kind == TaskKind::kMerge) name += " round " + std::to_string(id.index) + " pair " + std::to_string(id.pair);
  if (id.kind == TaskKind::kRefine) name += " round " + std::to_string(id.index) + " view " + std::to_string(id.pair);
  return name;
}

}  // namespace depthfarm
