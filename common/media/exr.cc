#include "common/media/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <openexr.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <utility>

#include "common/media/decoded_size.h"

namespace depthfarm {
namespace {

constexpr std::string_view kStart = "\x76\x2f\x31\x01";
constexpr const char* kChannel = "Z";
constexpr int kMaxSide = 32768;
constexpr int kNoThreads = 0;

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

// What the library allocates while this thread decodes a file: headers are believed before a pixel is read.
class Memory {
 public:
  explicit Memory(std::size_t most) { left_ = most; }
  ~Memory() { left_ = 0; }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  static void* Take(std::size_t bytes) {
    if (bytes > left_ || bytes + kHead > left_) return nullptr;
    auto* const block = static_cast<std::size_t*>(std::malloc(bytes + kHead));
    if (block == nullptr) return nullptr;
    *block = bytes + kHead;
    left_ -= *block;
    return reinterpret_cast<char*>(block) + kHead;
  }
  static void GiveBack(void* bytes) {
    if (bytes == nullptr) return;
    auto* const block = reinterpret_cast<std::size_t*>(static_cast<char*>(bytes) - kHead);
    left_ += *block;
    std::free(block);
  }

 private:
  static constexpr std::size_t kHead = alignof(std::max_align_t);
  static thread_local std::size_t left_;
};
thread_local std::size_t Memory::left_ = 0;

// A file in memory that the library reads.
class OpenExr {
 public:
  explicit OpenExr(std::string_view bytes) : bytes_(bytes) {
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};  // results tell
    options.alloc_fn = Memory::Take;
    options.free_fn = Memory::GiveBack;
    options.user_data = this;
    options.size_fn = [](exr_const_context_t, void* file) {
      return static_cast<std::int64_t>(static_cast<const OpenExr*>(file)->bytes_.size());
    };
    options.read_fn = [](exr_const_context_t, void* file, void* to, std::uint64_t size, std::uint64_t offset,
                         exr_stream_error_func_ptr_t) {
      const std::string_view all = static_cast<const OpenExr*>(file)->bytes_;
      if (offset > all.size()) return std::int64_t{-1};
      const std::string_view part = all.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
      std::ranges::copy(part, static_cast<char*>(to));
      return static_cast<std::int64_t>(part.size());
    };
    options.max_image_width = kMaxSide;
    options.max_image_height = kMaxSide;
    options.max_tile_width = kMaxSide;
    options.max_tile_height = kMaxSide;
    opened_ = exr_start_read(&context_, "file", &options);
  }
  ~OpenExr() {
    (void)exr_decoding_destroy(context_, &decoder_);
    (void)exr_finish(&context_);
  }
  OpenExr(const OpenExr&) = delete;
  OpenExr& operator=(const OpenExr&) = delete;

  [[nodiscard]] Result<Grid<float>> Read();

 private:
  [[nodiscard]] static Status Failure(exr_result_t code) {
    return InvalidArgument(std::string("is a damaged or unknown OpenEXR file: ") + exr_get_default_error_message(code));
  }
  // The channel to be read: Z, or the only one; null if there is neither.
  [[nodiscard]] static const exr_attr_chlist_entry_t* ChannelOf(const exr_attr_chlist_t& channels) {
    for (int i = 0; i < channels.num_channels; ++i) {
      if (std::string_view(channels.entries[i].name.str) == kChannel) return &channels.entries[i];
    }
    return channels.num_channels == 1 ? channels.entries : nullptr;
  }
  [[nodiscard]] Status ReadLines(int first, Grid<float>& values);
  [[nodiscard]] Status ReadTiles(Grid<float>& values);
  // Into `values` from (x, y) on.
  [[nodiscard]] Status ReadChunk(const exr_chunk_info_t& chunk, int x, int y, Grid<float>& values);

  std::string_view bytes_;
  exr_context_t context_ = nullptr;
  exr_result_t opened_ = EXR_ERR_SUCCESS;
  exr_decode_pipeline_t decoder_{};  // as EXR_DECODE_PIPELINE_INITIALIZER
  bool decodes_ = false;
  std::string channel_;
};

Result<Grid<float>> OpenExr::Read() {
  if (opened_ != EXR_ERR_SUCCESS) return Failure(opened_);
  int parts = 0;
  exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
  exr_attr_box2i_t data{};
  exr_attr_box2i_t display{};
  const exr_attr_chlist_t* channels = nullptr;
  for (const exr_result_t code :
       {exr_get_count(context_, &parts), exr_get_storage(context_, 0, &storage),
        exr_get_data_window(context_, 0, &data), exr_get_display_window(context_, 0, &display),
        exr_get_channels(context_, 0, &channels)}) {
    if (code != EXR_ERR_SUCCESS) return Failure(code);
  }
  if (parts != 1 || (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED))
    return InvalidArgument("has several parts or several depths a pixel: expected one picture");
  if (data.min.x != display.min.x || data.min.y != display.min.y || data.max.x != display.max.x ||
      data.max.y != display.max.y) {
    return InvalidArgument("has pixels outside of its picture, or lacks some");
  }
  const std::int64_t width = std::int64_t{data.max.x} - data.min.x + 1;
  const std::int64_t height = std::int64_t{data.max.y} - data.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    return InvalidArgument("has sides of " + std::to_string(width) + " and " + std::to_string(height) +
                           " pixels, expected 1 to " + std::to_string(kMaxSide));
  }
  if (static_cast<std::size_t>(width * height) * sizeof(float) > MostDecodedBytes(bytes_.size()))
    return InvalidArgument("says that it has more pixels than a file of its size holds");
  const exr_attr_chlist_entry_t* const channel = ChannelOf(*channels);
  if (channel == nullptr) return InvalidArgument("has several channels and none is Z: expected depth as channel Z");
  channel_ = channel->name.str;
  Grid<float> values(static_cast<int>(width), static_cast<int>(height));
  DEPTHFARM_RETURN_IF_ERROR(storage == EXR_STORAGE_TILED ? ReadTiles(values) : ReadLines(data.min.y, values));
  return values;
}

Status OpenExr::ReadLines(int first, Grid<float>& values) {
  std::int32_t lines = 0;
  if (const exr_result_t code = exr_get_scanlines_per_chunk(context_, 0, &lines); code != EXR_ERR_SUCCESS)
    return Failure(code);
  if (lines < 1) return Failure(EXR_ERR_INVALID_ATTR);
  for (int y = 0; y < values.height(); y += lines) {
    exr_chunk_info_t chunk{};
    const exr_result_t code = exr_read_scanline_chunk_info(context_, 0, first + y, &chunk);
    if (code != EXR_ERR_SUCCESS) return Failure(code);
    DEPTHFARM_RETURN_IF_ERROR(ReadChunk(chunk, 0, y, values));
  }
  return {};
}

Status OpenExr::ReadTiles(Grid<float>& values) {
  std::int32_t width = 0;
  std::int32_t height = 0;
  if (const exr_result_t code = exr_get_tile_sizes(context_, 0, 0, 0, &width, &height); code != EXR_ERR_SUCCESS)
    return Failure(code);
  if (width < 1 || height < 1) return Failure(EXR_ERR_INVALID_ATTR);
  for (int y = 0; y < values.height(); y += height) {
    for (int x = 0; x < values.width(); x += width) {
      exr_chunk_info_t chunk{};
      const exr_result_t code = exr_read_tile_chunk_info(context_, 0, x / width, y / height, 0, 0, &chunk);
      if (code != EXR_ERR_SUCCESS) return Failure(code);
      DEPTHFARM_RETURN_IF_ERROR(ReadChunk(chunk, x, y, values));
    }
  }
  return {};
}

Status OpenExr::ReadChunk(const exr_chunk_info_t& chunk, int x, int y, Grid<float>& values) {
  exr_result_t code = decodes_ ? exr_decoding_update(context_, 0, &chunk, &decoder_)
                               : exr_decoding_initialize(context_, 0, &chunk, &decoder_);
  if (code != EXR_ERR_SUCCESS) return Failure(code);
  for (int i = 0; i < decoder_.channel_count; ++i) {
    exr_coding_channel_info_t& channel = decoder_.channels[i];
    channel.decode_to_ptr = nullptr;  // is passed over
    if (channel_ != channel.channel_name) continue;
    if (channel.x_samples != 1 || channel.y_samples != 1)
      return InvalidArgument("has no value of channel " + channel_ + " for each pixel");
    if (channel.width < 1 || channel.height < 1 || channel.width > values.width() - x ||
        channel.height > values.height() - y) {
      return Failure(EXR_ERR_BAD_CHUNK_LEADER);
    }
    channel.user_data_type = EXR_PIXEL_FLOAT;
    channel.user_bytes_per_element = sizeof(float);
    channel.user_pixel_stride = sizeof(float);
    channel.user_line_stride = static_cast<std::int32_t>(sizeof(float)) * values.width();
    channel.decode_to_ptr = reinterpret_cast<std::uint8_t*>(&values(x, y));
  }
  if (!decodes_) code = exr_decoding_choose_default_routines(context_, 0, &decoder_);
  decodes_ = true;
  if (code == EXR_ERR_SUCCESS) code = exr_decoding_run(context_, 0, &decoder_);
  return code == EXR_ERR_SUCCESS ? Status() : Failure(code);
}

}  // namespace

bool IsExr(std::string_view bytes) { return bytes.starts_with(kStart); }

Result<Grid<float>> DecodeExr(std::string_view bytes) {
  if (!IsExr(bytes)) return InvalidArgument("is not an OpenEXR file");
  // Its tables and buffers beside the pixels: a file's rows may be compressed 256 at a time.
  const Memory memory(MostDecodedBytes(bytes.size()));
  OpenExr file(bytes);
  return file.Read();
}

Result<std::string> EncodeExr(const Grid<float>& values) {
  if (values.empty()) return InvalidArgument("an OpenEXR file has at least one pixel");
  // The library tells errors as exceptions, of its own kinds and of others.
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
