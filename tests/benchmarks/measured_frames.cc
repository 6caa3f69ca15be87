#include "tests/benchmarks/measured_frames.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <utility>

#include "common/job/level_partition.h"
#include "common/media/picture_reader.h"
#include "common/sequence/read_sequence.h"

namespace depthfarm::benchmarks {
namespace {

constexpr std::uint64_t kSeed = 117;
constexpr double kNoise = 1.5;  // grey levels, as `depthfarm scene`

}  // namespace

std::vector<Level> MeasuredFrame::LevelsOfFirstBlock() const {
  return LevelsOfBlock(job.params.levels, num_blocks, job.params.partition, 0);
}

MeasuredFrame::Block MeasuredFrame::BlockOf(std::vector<Level> levels) const {
  const FrameProblem frame(job, analysis);
  Block block;
  block.problem.num_nodes = frame.num_nodes();
  block.problem.levels = std::move(levels);
  block.problem.matches_per_node = frame.matches_per_node();
  block.problem.smoothness = frame.smoothness();
  block.problem.fixed.assign(frame.num_nodes(), 0);
  block.problem.matches = frame.MatchesOnLevels(block.problem.levels, {});
  block.start.assign(frame.num_nodes(), block.problem.levels.front());
  WinnerTakesAll(block.problem, block.start);
  return block;
}

namespace {

// A benchmark ends where its input is none.
template <typename T>
T ValueOrExit(Result<T> result) {
  if (result.ok()) return std::move(result).value();
  std::cerr << "depthfarm-benchmarks: " << result.status().message() << "\n";
  std::exit(2);
}

test::RenderedSequence FirstFrameOf(const std::string& file) {
  test::RenderedSequence read;
  read.sequence = ValueOrExit(ReadSequence(file));
  std::erase_if(read.sequence.cameras, [](const SequenceCamera& camera) { return camera.images.empty(); });
  read.pictures.emplace_back();
  for (const SequenceCamera& camera : read.sequence.cameras) {
    read.pictures.back().push_back(
        ValueOrExit(ReadPicture({camera.images.front(), camera.format, camera.camera.width, camera.camera.height}, 1)));
  }
  return read;
}

}  // namespace

const test::RenderedSequence& MeasuredFrames::Rendered() {
  if (!rendered_ && !workload_.sequence.empty()) rendered_ = FirstFrameOf(workload_.sequence);
  if (!rendered_) {
    rendered_ = test::Render(ArrayKind::kArc, workload_.views, workload_.width, workload_.height, 1, kSeed, kNoise);
  }
  return *rendered_;
}

const MeasuredFrame& MeasuredFrames::WithSegments(int segments) {
  const auto known = frames_.find(segments);
  if (known != frames_.end()) return known->second;
  EstimationParams params;
  params.segments = segments;
  MeasuredFrame frame = Frame(params);
  frame.num_blocks = std::max(2, frame.job.level_blocks_i);
  return frames_.emplace(segments, std::move(frame)).first->second;
}

const MeasuredFrame& MeasuredFrames::OfPaper() {
  if (paper_) return *paper_;
  EstimationParams params = Preset("paper").value();
  params.segments = workload_.paper_segments;
  params.levels = workload_.paper_levels;
  paper_ = Frame(params);
  return *paper_;
}

MeasuredFrame MeasuredFrames::Frame(const EstimationParams& params) {
  MeasuredFrame frame;
  frame.job = ResolveJob(Rendered().sequence, params).value();
  frame.analysis = test::Analyse(Rendered(), frame.job, 0);
  return frame;
}

}  // namespace depthfarm::benchmarks
