#include "common/media/picture_reader.h"
#include "common/media/raw_picture.h"
#include "tests/fuzz/fuzz_target.h"

// Four bytes say format, width, height and how often smaller; samples follow, repeated or cut to the right number where
// the format's highest bit asks for it, or else few inputs would have it.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  std::string_view rest = fuzz::Text(data, size);
  const unsigned format_byte = fuzz::TakeByte(rest);
  const PictureFormat format = {(format_byte & 1) != 0 ? PictureFormat::Kind::kYuv420 : PictureFormat::Kind::kYuv400,
                                static_cast<int>(8 + (format_byte >> 4 & 7)), (format_byte & 2) != 0,
                                (format_byte & 4) != 0};
  const int width = static_cast<int>(fuzz::TakeByte(rest)) + 1;
  const int height = static_cast<int>(fuzz::TakeByte(rest)) + 1;
  const int downscale = static_cast<int>(fuzz::TakeByte(rest)) % 6;
  std::string samples(rest);
  if ((format_byte & 0x80) != 0 && !rest.empty()) {
    const std::uint64_t expected = RawPictureBytes(format, width, height);
    while (samples.size() < expected) samples += rest;
    samples.resize(expected);
  }
  const auto picture = DecodePicture(samples, format, width, height, downscale);
  const auto luma = DecodeRawLuma(samples, format, width, height);
  if (!picture.ok()) return 0;
  ++fuzz::accepted;
  fuzz::Require(luma.ok() && luma->width() == width && luma->height() == height, "a picture has a luma plane");
  const PictureFormat limited = {PictureFormat::Kind::kYuv420, 8, false, false};
  const std::string encoded = EncodeLimitedYuv420(*picture);
  fuzz::Require(DecodeRawPicture(encoded, limited, picture->width(), picture->height(), 1).ok(),
                "a picture that was encoded can be decoded");
  return 0;
}
