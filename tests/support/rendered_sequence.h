#ifndef DEPTHFARM_TESTS_SUPPORT_RENDERED_SEQUENCE_H_
#define DEPTHFARM_TESTS_SUPPORT_RENDERED_SEQUENCE_H_

#include <cstdint>
#include <vector>

#include "common/image/picture.h"
#include "common/job/resolved_job.h"
#include "common/scene/array.h"
#include "common/sequence/sequence.h"
#include "worker/estimation/estimation.h"

namespace depthfarm::test {

// A small rendered sequence in memory, with exact depth.
struct RenderedSequence {
  Sequence sequence;                              // its picture paths name nothing
  std::vector<std::vector<YcbcrImage>> pictures;  // [frame][camera]
  std::vector<std::vector<DepthMap>> depth;       // [frame][camera], exact
  std::vector<std::vector<ZoneMap>> zones;        // [frame][camera]
};

RenderedSequence Render(ArrayKind kind, int cameras, int width, int height, int frames, std::uint64_t seed,
                        double noise);

// Analyses of one frame for the views of `job`, found in the sequence by name.
FrameAnalysis Analyse(const RenderedSequence& rendered, const ResolvedJob& job, int frame);

// All of a frame: estimate every block, merge them round by round. Fails the test on any error.
LabelField EstimateFrame(const ResolvedJob& job, const FrameAnalysis& analysis, const TemporalReferences* references,
                         int num_blocks, std::int64_t* energy = nullptr);

// E of eq. (1) of a whole label field over all levels of the job (nothing is fixed).
std::int64_t EnergyOfField(const ResolvedJob& job, const FrameAnalysis& analysis, const LabelField& field);

}  // namespace depthfarm::test

#endif  // DEPTHFARM_TESTS_SUPPORT_RENDERED_SEQUENCE_H_
