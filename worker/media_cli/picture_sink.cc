#include "worker/media_cli/picture_sink.h"

#include <filesystem>
#include <fstream>
#include <utility>

#include "common/files/atomic_file.h"
#include "common/files/open_file.h"
#include "common/files/pending_file.h"
#include "common/files/writable_folder.h"
#include "common/media/colour_map.h"
#include "common/media/raw_picture.h"
#include "common/sequence/frame_name.h"
#include "common/video/mp4_file.h"
#include "worker/media_cli/even_picture.h"

namespace depthfarm {
namespace {

class PngFolder : public PictureSink {
 public:
  explicit PngFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  Result<std::string> Encode(const YcbcrImage& picture) const override { return EncodeRgbPng(ToRgb(picture)); }
  Status Write(int number, const std::string& bytes) override {
    return WriteFileAtomically((folder_ / (FrameName(number) + ".png")).string(), bytes);
  }
  Status Finish() override { return {}; }

 private:
  std::filesystem::path folder_;
};

class YuvFile : public PictureSink {
 public:
  explicit YuvFile(const std::string& path)
      : file_(path), stream_(file_.temporary(), std::ios::binary | std::ios::trunc) {}

  [[nodiscard]] Status Check() const { return stream_ ? Status() : FileFailure(file_.path(), "write"); }
  Result<std::string> Encode(const YcbcrImage& picture) const override { return EncodeLimitedYuv420(picture); }
  Status Write(int /*number*/, const std::string& bytes) override {
    stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return Check();
  }
  Status Finish() override {
    stream_.close();
    DEPTHFARM_RETURN_IF_ERROR(Check());
    return file_.Commit();
  }

 private:
  PendingFile file_;
  std::ofstream stream_;
};

class Mp4 : public PictureSink {
 public:
  explicit Mp4(Mp4File file) : file_(std::move(file)) {}

  Result<std::string> Encode(const YcbcrImage& picture) const override {
    return EncodeLimitedYuv420(WithEvenSides(picture));
  }
  Status Write(int /*number*/, const std::string& bytes) override { return file_.Put(bytes); }
  Status Finish() override { return file_.Finish(); }

 private:
  Mp4File file_;
};

}  // namespace

Result<std::unique_ptr<PictureSink>> OpenPictureSink(const std::string& output, const PictureSinkFormat& format) {
  const std::filesystem::path path(output);
  const std::string extension = path.extension().string();
  if (extension == ".yuv" || extension == ".mp4") {
    const std::filesystem::path folder = path.parent_path();
    if (!folder.empty()) {
      DEPTHFARM_RETURN_IF_ERROR(CheckWritableFolder(folder.string()));
      DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(folder.string()));
    }
  }
  if (extension == ".mp4") {
    DEPTHFARM_ASSIGN_OR_RETURN(Mp4File file, Mp4File::Create(output, EvenSide(format.width), EvenSide(format.height),
                                                             format.frames_per_second));
    return std::unique_ptr<PictureSink>(std::make_unique<Mp4>(std::move(file)));
  }
  if (extension == ".yuv") {
    auto file = std::make_unique<YuvFile>(output);
    DEPTHFARM_RETURN_IF_ERROR(file->Check());
    return std::unique_ptr<PictureSink>(std::move(file));
  }
  for (const char* video : {".mkv", ".mov", ".avi", ".webm", ".y4m", ".h264", ".hevc", ".png", ".jpg"}) {
    if (extension == video) {
      return InvalidArgument("output '" + output + "': expected FILE.mp4, FILE.yuv or a folder for PNG pictures");
    }
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckWritableFolder(output));
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(output));
  return std::unique_ptr<PictureSink>(std::make_unique<PngFolder>(path));
}

}  // namespace depthfarm
