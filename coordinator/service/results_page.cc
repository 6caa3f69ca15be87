#include "coordinator/service/results_page.h"

#include <algorithm>
#include <cstddef>

#include "common/wire/results_wire.h"

namespace depthfarm {
namespace {

constexpr std::size_t kFilesOfPage = 20'000;

}  // namespace

v1::Results ResultsPage(const JobResults& results, std::uint32_t first_frame, const Locate& locate) {
  v1::Results page;
  const std::size_t num_frames = results.frames.size();
  const std::size_t num_views = results.picture_digests.size() / std::max<std::size_t>(1, num_frames);
  std::size_t frame = std::min<std::size_t>(first_frame, num_frames);
  // A frame that is not done counts too: looking at it takes time.
  for (std::size_t files = 0; frame < num_frames && files < kFilesOfPage; ++frame) {
    const JobResults::Frame& done = results.frames[frame];
    files += std::max<std::size_t>(1, done.files.size());
    if (!done.bundle) continue;
    const auto digests = results.picture_digests.begin() + static_cast<std::ptrdiff_t>(frame * num_views);
    *page.add_frames() =
        ToProto(FrameResult{.frame = static_cast<int>(frame),
                            .bundle = *done.bundle,
                            .locations = locate(done.bundle->key),
                            .files = done.files,
                            .picture_digests = {digests, digests + static_cast<std::ptrdiff_t>(num_views)}});
  }
  page.set_next_frame(static_cast<std::uint32_t>(frame));
  page.set_num_frames(static_cast<std::uint32_t>(num_frames));
  return page;
}

}  // namespace depthfarm
