#ifndef DEPTHFARM_TESTS_SIMULATION_JOB_SHAPES_H_
#define DEPTHFARM_TESTS_SIMULATION_JOB_SHAPES_H_

#include <string>

#include "common/wire/envelope.h"

namespace depthfarm::simulation {

// What a simulated job is like, apart from its folder.
struct JobKind {
  int shape = 0;              // 0 to kNumShapes - 1: frames, GOPs, blocks, rounds
  std::string pictures = {};  // equal names: equal pictures
  bool keeps_results = false;
  bool renders = false;           // views of depth that is there; not with keeps_results
  std::string sequence = "line";  // "poison": kills who estimates or renders; "unreadable": has a picture that is none

  auto operator<=>(const JobKind&) const = default;
};

inline constexpr int kNumShapes = 7;
inline constexpr int kSharedShape = 4;  // whose GOPs share an I frame
inline constexpr int kLongShape = 7;    // beside these: 40 frames

// The message that submits one. Without an output folder for a job that keeps its results.
[[nodiscard]] v1::SubmitJob Submission(const JobKind& kind, const std::string& name, const std::string& output_dir);

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_JOB_SHAPES_H_
