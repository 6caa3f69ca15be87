#include "common/video_input/video_readers.h"

#include <sys/stat.h>

#include <algorithm>
#include <utility>

#include "common/video_input/video_module.h"

namespace depthfarm {
namespace {

constexpr std::uint64_t kPicturesOfReader = 7;  // four that others refer to at 1920x1080, and those on their way

// Empty where the file cannot be looked at: then it is never the one of before.
std::string StateOf(const std::string& path) {
  struct stat facts {};
  if (stat(path.c_str(), &facts) != 0) return {};
  std::string state;
  for (const std::int64_t number : {static_cast<std::int64_t>(facts.st_dev), static_cast<std::int64_t>(facts.st_ino),
                                    static_cast<std::int64_t>(facts.st_size), std::int64_t{facts.st_mtim.tv_sec},
                                    std::int64_t{facts.st_mtim.tv_nsec}})
    state += std::to_string(number) + " ";
  return state;
}

bool SameVideo(const VideoFile& a, const VideoFile& b) {
  return a.path == b.path && a.format == b.format && a.width == b.width && a.height == b.height && a.frames == b.frames;
}

}  // namespace

Result<PictureBytes> VideoReaders::Read(const VideoFile& file, int frame) {
  const std::string state = StateOf(file.path);
  std::unique_ptr<VideoReader> reader = Take(file, state);
  if (reader == nullptr) {
    Result<std::unique_ptr<VideoReader>> opened = OpenVideo(file);
    if (!opened.ok()) return opened.status().WithContext(file.path);
    reader = std::move(*opened);
  }
  Result<PictureBytes> picture = reader->Read(frame);
  if (!picture.ok()) return picture.status().WithContext(file.path);
  if (!state.empty()) Keep({file, state, std::move(reader), kPicturesOfReader * picture->bytes.size()});
  return picture;
}

int VideoReaders::num_idle() const {
  const std::scoped_lock lock(mutex_);
  return static_cast<int>(idle_.size());
}

std::unique_ptr<VideoReader> VideoReaders::Take(const VideoFile& file, const std::string& state) {
  const std::scoped_lock lock(mutex_);
  std::erase_if(idle_, [&](const Idle& idle) { return idle.file.path == file.path && idle.state != state; });
  const auto found = std::ranges::find_if(idle_, [&](const Idle& idle) { return SameVideo(idle.file, file); });
  if (found == idle_.end()) return nullptr;
  std::unique_ptr<VideoReader> reader = std::move(found->reader);
  idle_.erase(found);
  return reader;
}

void VideoReaders::Keep(Idle idle) {
  std::list<Idle> closed;  // without the lock
  const std::scoped_lock lock(mutex_);
  idle_.push_front(std::move(idle));
  std::uint64_t bytes = 0;
  auto last = idle_.begin();
  while (last != idle_.end() && bytes + last->bytes <= kIdleBytes) bytes += (last++)->bytes;
  closed.splice(closed.begin(), idle_, last, idle_.end());
}

}  // namespace depthfarm
