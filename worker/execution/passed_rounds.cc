#include "worker/execution/passed_rounds.h"

#include <algorithm>
#include <limits>

namespace depthfarm {

std::vector<ArtifactKey> PassedRounds::PassedBy(const TaskSpec& spec) {
  std::vector<ArtifactKey> passed;
  const TaskId& id = spec.id;
  const bool refines = id.kind == TaskKind::kRefine;
  if (!refines && id.kind != TaskKind::kAssess && id.kind != TaskKind::kEmit) return passed;
  for (const TaskInput& input : spec.inputs) {
    if (input.role != InputRole::kRefined) continue;
    // Of the others some may still have to do this round, from what theirs was before.
    if (refines) Take(id, input.view, id.index - (input.view == id.pair ? 1 : 2), passed);
    if (!refines) Take(id, input.view, std::numeric_limits<int>::max(), passed);
    if (refines) Remember({id.job, id.frame, input.view, id.index - 1, input.artifact.key});
  }
  // What Assess and Emit read is needed once more: by each other.
  std::erase_if(passed, [&](const ArtifactKey& key) {
    return std::any_of(spec.inputs.begin(), spec.inputs.end(),
                       [&](const TaskInput& input) { return input.artifact.key == key; });
  });
  if (refines && spec.output_key.has_value()) Remember({id.job, id.frame, id.pair, id.index, *spec.output_key});
  return passed;
}

void PassedRounds::Remember(const Round& round) {
  const auto same = [&](const Round& known) { return known.key == round.key; };
  if (std::any_of(rounds_.begin(), rounds_.end(), same)) return;
  if (rounds_.size() == kMostRemembered) rounds_.pop_front();
  rounds_.push_back(round);
}

void PassedRounds::Take(const TaskId& of, int view, int round, std::vector<ArtifactKey>& passed) {
  std::erase_if(rounds_, [&](const Round& known) {
    const bool gone = known.job == of.job && known.frame == of.frame && known.view == view && known.round < round;
    if (gone) passed.push_back(known.key);
    return gone;
  });
}

}  // namespace depthfarm
