#ifndef DEPTHFARM_WORKER_ESTIMATION_REWARD_FLOORS_H_
#define DEPTHFARM_WORKER_ESTIMATION_REWARD_FLOORS_H_

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <vector>

#include "common/job/resolved_job.h"
#include "worker/estimation/estimation.h"

namespace depthfarm {

// The floors of a frame's matches (cost/uniqueness.h; match steps), one per node and slot, kept as they are measured:
// all parts and merges of a frame ask for the same ones, and each costs kFloorPlanes windows. Not thread-safe.
class RewardFloors {
 public:
  static constexpr std::uint16_t kNotMeasured = 0xFFFF;  // above every reward

  // Nothing measured; a frame that has been here with as many keeps what it has.
  void Resize(std::size_t count) {
    if (floors_.size() != count) floors_.assign(count, kNotMeasured);
  }
  [[nodiscard]] std::uint16_t& operator[](std::size_t index) { return floors_[index]; }

 private:
  std::vector<std::uint16_t> floors_;
};

// The floors of the last few frames, for the tasks of a frame that run one after the other. Only saves time: floors are
// a function of pictures, segments and job alone. Not thread-safe.
class FloorMemory {
 public:
  // The same object again for the same analyses (the objects, not their values) and equal jobs, as long as it is among
  // the kFrames last used.
  [[nodiscard]] std::shared_ptr<RewardFloors> Of(const ResolvedJob& job, const FrameAnalysis& analysis);

 private:
  static constexpr std::size_t kFrames = 4;  // I frames of several GOPs take turns

  struct Frame {
    std::vector<std::weak_ptr<const ViewAnalysis>> analysis;  // weak: an evicted analysis is not kept alive
    EstimationParams params;
    Camera reference;
    std::vector<Camera> cameras;
    std::vector<std::vector<int>> neighbours;
    std::shared_ptr<RewardFloors> floors;
  };
  [[nodiscard]] static bool IsOf(const Frame& frame, const ResolvedJob& job, const FrameAnalysis& analysis);

  std::list<Frame> frames_;  // most recently used first
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ESTIMATION_REWARD_FLOORS_H_
