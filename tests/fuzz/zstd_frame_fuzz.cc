#include "common/compression/zstd_frame.h"
#include "tests/fuzz/fuzz_target.h"

// The first byte bounds what the frame may hold.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  std::string_view frame = fuzz::Text(data, size);
  const std::size_t least = fuzz::TakeByte(frame);
  const auto start = ReadZstdFrameStart(frame, least);
  const auto content = ReadZstdFrame(frame, least, std::size_t{1} << 24);
  if (!content.ok()) return 0;
  ++fuzz::accepted;
  fuzz::Require(start.ok() && content->starts_with(*start), "a whole frame begins as its start says");
  std::string again;
  AppendZstdFrame(*content, again);
  fuzz::Require(ReadZstdFrame(again, content->size(), content->size()).value() == *content, "content comes back");
  return 0;
}
