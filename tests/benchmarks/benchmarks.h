#ifndef DEPTHFARM_TESTS_BENCHMARKS_BENCHMARKS_H_
#define DEPTHFARM_TESTS_BENCHMARKS_BENCHMARKS_H_

#include <cstddef>

#include "tests/benchmarks/measured_frames.h"

namespace depthfarm::benchmarks {

// Register the benchmarks with the library; `frames` and `failed` must outlive their run. A wrong result sets `failed`:
// the library itself ends with success.
void RegisterStageBenchmarks(MeasuredFrames& frames, bool& failed);
void RegisterFlowBenchmarks(MeasuredFrames& frames, bool& failed);
// An artifact of that size moves between processes so many times, and small ones oftener, in turn with bare ZeroMQ.
void RegisterTransferBenchmarks(std::size_t artifact_bytes, int rounds, bool& failed);

// A coordinator whose journal has a job of so many frames, half of them done, goes on with it.
void RegisterRestartBenchmarks(int frames, bool& failed);

}  // namespace depthfarm::benchmarks

#endif  // DEPTHFARM_TESTS_BENCHMARKS_BENCHMARKS_H_
