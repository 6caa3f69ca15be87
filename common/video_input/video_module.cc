#include "common/video_input/video_module.h"

#include <dlfcn.h>

#include <array>
#include <filesystem>
#include <string>
#include <system_error>

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

// Where the module is, from the folder of the program: of an installation, of a build, of a build's tests.
constexpr std::array<const char*, 3> kPlaces = {DEPTHFARM_MODULE_FROM_BIN, "depthfarm-video.so",
                                                "../bin/depthfarm-video.so"};

struct VideoModule {
  OpenVideoFunction open = nullptr;
};

Result<VideoModule> Load() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return Unavailable("cannot tell where this program is: /proc/self/exe: " + error.message());
  fs::path module;
  for (const char* place : kPlaces) {
    module = (program.parent_path() / place).lexically_normal();
    if (fs::exists(module, error)) break;
  }
  const auto reason = [] {
    const char* text = dlerror();  // NOLINT(concurrency-mt-unsafe): glibc keeps it for each thread
    return std::string(text == nullptr ? "for no reason that is told" : text);
  };
  void* handle = dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) return Unavailable("videos need the module depthfarm-video.so of this program: " + reason());
  void* function = dlsym(handle, kOpenVideoName);
  if (function == nullptr) return Unavailable(module.string() + ": is no module of depthfarm: " + reason());
  return VideoModule{reinterpret_cast<OpenVideoFunction>(function)};
}

const Result<VideoModule>& Module() {
  static const Result<VideoModule> module = Load();  // stays for the life of the process
  return module;
}

}  // namespace

Status LoadVideoModule() { return Module().status(); }

Result<std::unique_ptr<VideoReader>> OpenVideo(const VideoFile& file) {
  DEPTHFARM_RETURN_IF_ERROR(Module().status());
  Result<std::unique_ptr<VideoReader>> reader = Internal("the video module did not answer");
  Module()->open(DEPTHFARM_VERSION, &file, &reader);
  return reader;
}

}  // namespace depthfarm
