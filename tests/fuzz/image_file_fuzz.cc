#include "common/media/depth_file.h"
#include "common/media/grey_picture.h"
#include "common/media/guide_files.h"
#include "common/media/picture_reader.h"
#include "tests/fuzz/fuzz_target.h"

// Image files as every reader of ours takes them. The decoders of PNG, JPEG and so on are the system's; they are not
// instrumented, but what they read and write of ours is watched.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  const std::string_view bytes = fuzz::Text(data, size);
  const auto picture = DecodePicture(bytes, PictureFormat(), 16, 12, 2);
  const auto prior = DecodePrior(bytes, {.holds = PriorFormat::Holds::kCodes, .z_near = 1, .z_far = 2}, 32, 24);
  const auto share = DecodeShare(bytes, 32, 24);
  if (picture.ok()) {
    ++fuzz::accepted;
    YcbcrImage masked = *picture;
    (void)ApplyMask(bytes, masked);
  }
  if (share.ok()) {
    for (const float value : share->values()) fuzz::Require(value >= 0 && value <= 1, "a share is one");
  }
  const auto codes = DecodeDepthPng(bytes);
  if (!codes.ok()) return 0;
  ++fuzz::accepted;
  fuzz::Require(DecodeDepthPng(EncodeDepthPng(*codes).value()).value() == *codes, "codes come back");
  return 0;
}
