#ifndef DEPTHFARM_COMMON_VIDEO_HEVC_RATE_H_
#define DEPTHFARM_COMMON_VIDEO_HEVC_RATE_H_

#include <cstdint>
#include <memory>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// What a video costs and keeps at one quantiser.
struct HevcRate {
  int qp = 0;
  int pictures = 0;
  double bits_per_picture = 0;
  double psnr = 0;  // of luma as stored, dB, peak 2^bits - 1: the mean of the pictures', as HM reports it
};

// HEVC in the manner of HM's low-delay configuration, by libx265: the first picture intra, all others predicted from
// earlier ones only, no B pictures, no look-ahead, one constant quantiser (x265 takes 3 less for the intra picture).
// Depth that flickers makes virtual views that are hard to predict: their bits measure its temporal consistency
// (paper V, Tables III and VIII). One thread: equal pictures give equal bits.
class HevcRateMeter {
 public:
  // Pictures of `width` x `height` (even, at least 16), planar 4:2:0 of 8 bits, or of 10 in two bytes little-endian.
  // Errors  kInvalidArgument: sizes, bits or a quantiser outside 0..51; kUnavailable: no HEVC encoder in this libav.
  [[nodiscard]] static Result<HevcRateMeter> Create(int width, int height, int bits, int qp);

  HevcRateMeter(HevcRateMeter&&) noexcept;
  HevcRateMeter& operator=(HevcRateMeter&&) noexcept;
  ~HevcRateMeter();

  [[nodiscard]] Status Put(std::string_view picture);
  // After the last picture. kInvalidArgument: there was none.
  [[nodiscard]] Result<HevcRate> Finish();

 private:
  struct Codec;
  explicit HevcRateMeter(std::unique_ptr<Codec> codec);
  std::unique_ptr<Codec> codec_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_VIDEO_HEVC_RATE_H_
