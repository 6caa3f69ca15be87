#ifndef DEPTHFARM_TESTS_BENCHMARKS_MEASURED_FRAMES_H_
#define DEPTHFARM_TESTS_BENCHMARKS_MEASURED_FRAMES_H_

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/job/resolved_job.h"
#include "tests/support/rendered_sequence.h"
#include "worker/estimation/frame_problem.h"
#include "worker/optimization/labelling_problem.h"

namespace depthfarm::benchmarks {

// What is measured: a frame of the project's own arc scene, or the first one of a sequence, cut in different ways.
struct Workload {
  std::string sequence = {};  // its file; empty: the scene, of the next three
  int views = 5;
  int width = 1920;
  int height = 1080;
  int snic_segments = 103'680;                      // one per 20 pixels of 1920x1080
  std::vector<int> flow_segments{50'000, 100'000};  // of each view, for graphs of moves; 0: as many as the job chooses
  int paper_segments = 20'000;                      // of each view, for searches of the paper's energy
  int paper_levels = 250;
};

// The frame as a job with default options sees it.
struct MeasuredFrame {
  ResolvedJob job;
  FrameAnalysis analysis;
  int num_blocks = 1;  // n of IV-A: the job's, at least 2

  // The problem of block 0, with the start that EstimateBlock gives it.
  struct Block {
    LabellingProblem problem;
    std::vector<Level> start;
  };
  [[nodiscard]] Block FirstBlock() const { return BlockOf(LevelsOfFirstBlock()); }
  // The problem of some levels, with that start.
  [[nodiscard]] Block BlockOf(std::vector<Level> levels) const;
  [[nodiscard]] std::vector<Level> LevelsOfFirstBlock() const;
};

// Renders and analyses frames when they are first asked for, so that a benchmark that is left out costs nothing.
class MeasuredFrames {
 public:
  explicit MeasuredFrames(Workload workload) : workload_(std::move(workload)) {}

  [[nodiscard]] const Workload& workload() const { return workload_; }
  [[nodiscard]] const YcbcrImage& FirstPicture() { return Rendered().pictures.front().front(); }
  // With so many segments in each view; 0: as many as the job chooses.
  [[nodiscard]] const MeasuredFrame& WithSegments(int segments);
  // With every match in full, as --preset paper has it; n = 1.
  [[nodiscard]] const MeasuredFrame& OfPaper();

 private:
  [[nodiscard]] const test::RenderedSequence& Rendered();
  [[nodiscard]] MeasuredFrame Frame(const EstimationParams& params);

  Workload workload_;
  std::optional<test::RenderedSequence> rendered_;
  std::map<int, MeasuredFrame> frames_;
  std::optional<MeasuredFrame> paper_;
};

}  // namespace depthfarm::benchmarks

#endif  // DEPTHFARM_TESTS_BENCHMARKS_MEASURED_FRAMES_H_
