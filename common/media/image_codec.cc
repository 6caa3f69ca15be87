#include "common/media/image_codec.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <new>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "common/media/decoded_size.h"

namespace depthfarm {
namespace {

constexpr std::string_view kJpegStart = "\xff\xd8\xff";

// With the zeros that it holds.
template <std::size_t kSize>
constexpr std::string_view Start(const char (&text)[kSize]) {
  return {text, kSize - 1};
}

// OpenCV reads these from memory. What else it knows by its content it, or GDAL for it, reads from a copy in the folder
// for temporary files, which stays there when such a file is damaged; and none of it has samples that are taken.
constexpr std::array kStarts{Start("\x89PNG\r\n\x1a\n"),
                             kJpegStart,
                             Start("II*\0"),
                             Start("MM\0*"),
                             Start("II+\0"),
                             Start("MM\0+"),
                             Start("BM"),
                             Start("\0\0\0\x0cjP  \r\n\x87\n"),
                             Start("\xff\x4f\xff\x51")};

bool IsOfKnownKind(std::string_view bytes) {
  if (bytes.starts_with("RIFF") && bytes.substr(std::min<std::size_t>(bytes.size(), 8)).starts_with("WEBP"))
    return true;
  if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6') return true;  // PBM, PGM, PPM
  return std::ranges::any_of(kStarts, [&](std::string_view start) { return bytes.starts_with(start); });
}

std::uint8_t ByteAt(std::string_view bytes, std::size_t position) { return static_cast<std::uint8_t>(bytes[position]); }

// Position after the entropy-coded data that begins at `position`: of the next 0xff that begins a marker, or npos.
std::size_t EndOfScan(std::string_view bytes, std::size_t position) {
  while (true) {
    position = bytes.find('\xff', position);
    if (position == std::string_view::npos || position + 1 >= bytes.size()) return std::string_view::npos;
    const std::uint8_t code = ByteAt(bytes, position + 1);
    const bool stuffed_or_restart = code == 0x00 || (code >= 0xd0 && code <= 0xd7);
    if (!stuffed_or_restart) return position;
    position += 2;
  }
}

struct TooLarge {
  int width;
  int height;
};

// OpenCV takes memory for a picture as soon as it has read the header, and from nowhere else but the default allocator
// once that of the picture has refused. So this one is the default; it bounds pictures of the thread that decodes.
class BoundedAllocator final : public cv::MatAllocator {
 public:
  // For as long as it lives.
  class Bound {
   public:
    explicit Bound(std::size_t most) { most_ = most; }
    ~Bound() { most_ = SIZE_MAX; }
    Bound(const Bound&) = delete;
    Bound& operator=(const Bound&) = delete;
  };
  static void Install() {
    static BoundedAllocator allocator;
    static const bool installed = (cv::Mat::setDefaultAllocator(&allocator), true);
    (void)installed;
  }

  // `data` that is given needs no memory.
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, std::size_t* step, cv::AccessFlag flags,
                         cv::UMatUsageFlags usage) const override {
    if (dims == 2 && data == nullptr &&
        static_cast<std::size_t>(sizes[0]) * static_cast<std::size_t>(sizes[1]) * CV_ELEM_SIZE(type) > most_)
      throw TooLarge{sizes[1], sizes[0]};
    return standard_.allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return standard_.allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* data) const override { standard_.deallocate(data); }

 private:
  static thread_local std::size_t most_;
  const cv::MatAllocator& standard_ = *cv::Mat::getStdAllocator();
};

thread_local std::size_t BoundedAllocator::most_ = SIZE_MAX;

}  // namespace

bool IsCompleteJpeg(std::string_view bytes) {
  std::size_t position = 2;
  while (position + 1 < bytes.size()) {
    if (ByteAt(bytes, position) != 0xff) return false;
    const std::uint8_t code = ByteAt(bytes, position + 1);
    if (code == 0xff) {  // fill byte
      ++position;
      continue;
    }
    if (code == 0xd9) return true;
    if (position + 3 >= bytes.size()) return false;
    position += 2 + (std::size_t{ByteAt(bytes, position + 2)} << 8) + ByteAt(bytes, position + 3);
    if (code == 0xda) {
      position = EndOfScan(bytes, position);
      if (position == std::string_view::npos) return false;
    }
  }
  return false;
}

Result<cv::Mat> DecodeImage(std::string_view bytes) {
  if (bytes.empty()) return InvalidArgument("holds no bytes, expected an image file");
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    return InvalidArgument("holds " + std::to_string(bytes.size()) + " bytes, expected less than 2 GiB");
  }
  if (!IsOfKnownKind(bytes)) {
    return InvalidArgument(
        "cannot be decoded: begins like no PNG, JPEG, TIFF, BMP, PBM, PGM, PPM, WebP or JPEG 2000 file");
  }
  if (bytes.starts_with(kJpegStart) && !IsCompleteJpeg(bytes)) {
    return InvalidArgument("is a JPEG file that ends early, after " + std::to_string(bytes.size()) + " bytes");
  }
  try {
    const cv::Mat wrapped(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
    BoundedAllocator::Install();
    const BoundedAllocator::Bound bound(MostDecodedBytes(bytes.size()));
    cv::Mat image = cv::imdecode(wrapped, cv::IMREAD_UNCHANGED);
    if (image.empty()) {
      return InvalidArgument("cannot be decoded: damaged or cut short (" + std::to_string(bytes.size()) + " bytes)");
    }
    const bool unsigned_samples = image.depth() == CV_8U || image.depth() == CV_16U;
    const bool known_channels = image.channels() == 1 || image.channels() == 3 || image.channels() == 4;
    if (!unsigned_samples || !known_channels) {
      return InvalidArgument("has " + std::to_string(image.channels()) + " channels of OpenCV depth " +
                             std::to_string(image.depth()) + ", expected 1, 3 or 4 of 8 or 16 bits");
    }
    return image;
  } catch (const TooLarge& size) {
    return InvalidArgument("says that it has " + std::to_string(size.width) + "x" + std::to_string(size.height) +
                           " pixels, which its " + std::to_string(bytes.size()) + " bytes cannot hold: damaged");
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) return Unavailable("no memory to decode it");
    return InvalidArgument(std::string("cannot be decoded: ") + error.what());
  } catch (const std::bad_alloc&) {
    return Unavailable("no memory to decode it");
  }
}

}  // namespace depthfarm
