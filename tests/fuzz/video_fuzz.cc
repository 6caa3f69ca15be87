#include <sys/mman.h>
#include <unistd.h>

#include "common/files/open_file.h"
#include "common/video_input/module/av_video_reader.h"
#include "tests/fuzz/fuzz_target.h"

// Videos as workers read them. libav's containers and decoders are the system's; they are not instrumented, but what
// they are asked for and what becomes of their pictures is ours.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  constexpr int kWidth = 16;
  constexpr int kHeight = 16;
  const OpenFile file(memfd_create("video", MFD_CLOEXEC));
  const std::string_view bytes = fuzz::Text(data, size);
  fuzz::Require(file.ok() && write(file.descriptor(), bytes.data(), bytes.size()) == ssize_t(bytes.size()), "a file");
  const std::string path = "/proc/self/fd/" + std::to_string(file.descriptor());
  const auto reader = AvVideoReader::Open({path, {.kind = PictureFormat::Kind::kVideo}, kWidth, kHeight});
  if (!reader.ok()) return 0;
  for (const int frame : {0, 3, 1, 60}) {
    const auto picture = (*reader)->Read(frame);
    if (!picture.ok()) continue;
    ++fuzz::accepted;
    fuzz::Require(picture->format.raw() && !picture->format.of_all_frames(), "planes");
    fuzz::Require(picture->bytes.size() == RawPictureBytes(picture->format, kWidth, kHeight), "all of them");
  }
  return 0;
}
