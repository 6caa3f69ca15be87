#include "worker/estimation/reward_floors.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace depthfarm {

bool FloorMemory::IsOf(const Frame& frame, const ResolvedJob& job, const FrameAnalysis& analysis) {
  if (frame.params != job.params || frame.reference != job.reference || frame.cameras.size() != job.views.size() ||
      frame.analysis.size() != analysis.size())
    return false;
  for (std::size_t v = 0; v < job.views.size(); ++v) {
    if (frame.cameras[v] != job.views[v].camera || frame.neighbours[v] != job.views[v].neighbours) return false;
  }
  return std::equal(frame.analysis.begin(), frame.analysis.end(), analysis.begin(),
                    [](const auto& kept, const auto& asked) { return asked != nullptr && kept.lock() == asked; });
}

std::shared_ptr<RewardFloors> FloorMemory::Of(const ResolvedJob& job, const FrameAnalysis& analysis) {
  const auto known =
      std::find_if(frames_.begin(), frames_.end(), [&](const Frame& frame) { return IsOf(frame, job, analysis); });
  if (known != frames_.end()) {
    frames_.splice(frames_.begin(), frames_, known);
    return frames_.front().floors;
  }
  Frame frame{.analysis = {analysis.begin(), analysis.end()},
              .params = job.params,
              .reference = job.reference,
              .cameras = {},
              .neighbours = {},
              .floors = std::make_shared<RewardFloors>()};
  for (const JobView& view : job.views) {
    frame.cameras.push_back(view.camera);
    frame.neighbours.push_back(view.neighbours);
  }
  frames_.push_front(std::move(frame));
  if (frames_.size() > kFrames) frames_.pop_back();
  return frames_.front().floors;
}

}  // namespace depthfarm
