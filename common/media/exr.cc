#include "common/media/exr.h"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <stdexcept>

namespace depthfarm {
namespace {

constexpr std::string_view kStart = "\x76\x2f\x31\x01";
constexpr const char* kChannel = "Z";
constexpr int kMaxSide = 32768;
// Decoded bytes that a file may say it holds, for each of its own; small pictures may be of any kind (image_codec.cc).
constexpr std::size_t kMostBytesOfSmall = std::size_t{64} << 20;
constexpr std::size_t kMostExpansion = 9000;
constexpr int kNoThreads = 0;

class Source final : public Imf::IStream {
 public:
  explicit Source(std::string_view bytes) : IStream("the file"), bytes_(bytes) {}
  bool read(char* to, int count) override {
    if (count < 0 || static_cast<std::size_t>(count) > bytes_.size() - position_)
      throw std::runtime_error("ends too early");
    std::memcpy(to, bytes_.data() + position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override {
    if (position > bytes_.size()) throw std::runtime_error("ends too early");
    position_ = static_cast<std::size_t>(position);
  }

 private:
  std::string_view bytes_;
  std::size_t position_ = 0;
};

class Sink final : public Imf::OStream {
 public:
  Sink() : OStream("the file") {}
  void write(const char* from, int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (bytes_.size() < position_ + size) bytes_.resize(position_ + size);
    std::memcpy(bytes_.data() + position_, from, size);
    position_ += size;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = static_cast<std::size_t>(position); }
  [[nodiscard]] std::string Take() && { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t position_ = 0;
};

// Z, or the only channel; "" if there is neither.
std::string ChannelOf(const Imf::ChannelList& channels) {
  if (channels.findChannel(kChannel) != nullptr) return kChannel;
  const auto first = channels.begin();
  if (first == channels.end()) return "";
  auto second = first;
  return ++second == channels.end() ? first.name() : "";
}

Result<Grid<float>> Decode(std::string_view bytes) {
  Source source(bytes);
  Imf::InputFile file(source, kNoThreads);
  const Imath::Box2i window = file.header().dataWindow();
  if (window != file.header().displayWindow())
    return InvalidArgument("has pixels outside of its picture, or lacks some");
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    return InvalidArgument("has sides of " + std::to_string(width) + " and " + std::to_string(height) +
                           " pixels, expected 1 to " + std::to_string(kMaxSide));
  }
  const auto decoded = static_cast<std::size_t>(width * height) * sizeof(float);
  if (decoded > std::max(kMostBytesOfSmall, bytes.size() * kMostExpansion))
    return InvalidArgument("says that it has more pixels than a file of its size holds");
  const std::string channel = ChannelOf(file.header().channels());
  if (channel.empty()) return InvalidArgument("has several channels and none is Z: expected depth as channel Z");
  const Imf::Channel& sampled = file.header().channels()[channel.c_str()];
  if (sampled.xSampling != 1 || sampled.ySampling != 1)
    return InvalidArgument("has no value of channel " + channel + " for each pixel");
  Grid<float> values(static_cast<int>(width), static_cast<int>(height));
  Imf::FrameBuffer frame;
  frame.insert(channel, Imf::Slice::Make(Imf::FLOAT, values.values().data(), window));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  return values;
}

}  // namespace

bool IsExr(std::string_view bytes) { return bytes.starts_with(kStart); }

Result<Grid<float>> DecodeExr(std::string_view bytes) {
  if (!IsExr(bytes)) return InvalidArgument("is not an OpenEXR file");
  // The library tells errors as exceptions, of its own kinds and of others.
  try {
    return Decode(bytes);
  } catch (const std::exception& error) {
    return InvalidArgument(std::string("is a damaged or unknown OpenEXR file: ") + error.what());
  }
}

Result<std::string> EncodeExr(const Grid<float>& values) {
  if (values.empty()) return InvalidArgument("an OpenEXR file has at least one pixel");
  try {
    Imf::Header header(values.width(), values.height());
    // Of the kinds without loss the smallest for depth, 2.5 bytes a pixel instead of 3.5 of ZIP, and not the slowest.
    header.compression() = Imf::PIZ_COMPRESSION;
    header.channels().insert(kChannel, Imf::Channel(Imf::FLOAT));
    Sink sink;
    {
      Imf::OutputFile file(sink, header, kNoThreads);
      Imf::FrameBuffer frame;
      frame.insert(kChannel, Imf::Slice::Make(Imf::FLOAT, values.values().data(), header.dataWindow()));
      file.setFrameBuffer(frame);
      file.writePixels(values.height());
    }  // which writes where lines are
    return std::move(sink).Take();
  } catch (const std::exception& error) {
    return Internal(std::string("OpenEXR: ") + error.what());
  }
}

}  // namespace depthfarm
