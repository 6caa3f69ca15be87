#include "common/job/resolved_job.h"
#include "common/sequence/read_sequence.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

bool Below(const std::vector<std::string>& paths, std::string_view folder) {
  return std::all_of(paths.begin(), paths.end(), [&](const std::string& path) { return path.starts_with(folder); });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  const std::string_view text = fuzz::Text(data, size);
  (void)ParseSequence(text, "/sequences/one/sequence.json", {.allow_outside = true});
  const auto sequence = ParseSequence(text, "/sequences/one/sequence.json");
  if (!sequence.ok()) return 0;
  for (const SequenceCamera& camera : sequence->cameras) {
    for (const auto* paths : {&camera.images, &camera.masks, &camera.depth})
      fuzz::Require(Below(*paths, "/sequences/one/"), "files of a sequence stay in its folder");
  }
  const auto job = ResolveJob(*sequence, EstimationParams());
  if (!job.ok()) return 0;
  ++fuzz::accepted;
  fuzz::Require(job->Levels().count() == job->params.levels, "a resolved job has levels");
  fuzz::Require(SearchStep(*job, job->level_blocks_i) >= 1, "a search goes on");
  return 0;
}
