#ifndef DEPTHFARM_COORDINATOR_LIBRARY_DEPTHFARM_H_
#define DEPTHFARM_COORDINATOR_LIBRARY_DEPTHFARM_H_

// depthfarm as a library: pictures and cameras in, depth maps out, in the calling process, without a farm. This header
// needs the standard library alone; CMake: find_package(depthfarm), target depthfarm::depthfarm.

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#if defined(__GNUC__)
#define DEPTHFARM_LIBRARY_API __attribute__((visibility("default")))
#else
#define DEPTHFARM_LIBRARY_API
#endif

namespace depthfarm::library {

// A pinhole camera without distortion: x_cam = R * X_world + t, +z forward, +y down; pixel (0, 0) is the centre of the
// top-left pixel. Matrices row by row.
struct Camera {
  std::string name;  // a file name: without '/', not empty, another one for each camera
  int width = 0;     // pixels
  int height = 0;
  std::array<double, 9> K{};
  std::array<double, 9> R{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 3> t{};  // unit of the scene
};

// A picture in the caller's memory, which must stay there during the call.
struct Picture {
  const void* samples = nullptr;  // rows from top to bottom
  int channels = 3;               // 1: grey; 3: red, green, blue
  int bytes_per_sample = 1;       // 1: 0 to 255; 2: 0 to 65535, in the machine's byte order
  std::size_t row_bytes = 0;      // from one row to the next; 0: rows follow each other
};

// What the cameras saw.
struct Scene {
  std::vector<Camera> cameras;               // two or more
  std::vector<std::vector<Picture>> frames;  // of each frame a picture of each camera, of its size
  double z_near = 0;                         // depth range along the axis of the reference camera
  double z_far = 0;
  std::string reference;  // name of a camera; empty: the central one
};

struct Progress {
  int frames_done = 0;
  int frames = 0;
  double done = 0;  // of the work, 0 to 1
};

struct Options {
  // Estimation options by the names of `depthfarm run --help`, without dashes: {"preset", "fast"}, {"levels", "64"}.
  std::map<std::string, std::string> estimation;
  int threads = 0;      // 0: as many as the processor has
  std::string scratch;  // folder for intermediate files, emptied again; empty: the system's for temporary files
  // Called by the thread of the call before anything is computed, several times a second, and once more when all is
  // done; false cancels what is not done yet.
  std::function<bool(const Progress&)> progress;
};

// Row by row, of the size of the camera's pictures (smaller with the option downscale).
struct DepthMap {
  int width = 0;
  int height = 0;
  std::vector<float> z;           // along the camera's own axis, unit of the scene; 0: no depth
  std::vector<float> confidence;  // with the option confidence: how likely z is right, 0 to 1; else empty
};

enum class Code {
  kDone,
  kBadInput,   // the scene or an option is wrong: the same call will never work
  kFailed,     // no memory or disk, or a bug
  kCancelled,  // by progress
};

struct Result {
  Code code = Code::kFailed;
  std::string message;                       // why it is not kDone
  std::vector<std::vector<DepthMap>> depth;  // of each frame, of each camera, in their order
};

// Estimates the depth of all cameras together. The same depth, to the bit, as `depthfarm run` of the same pictures as
// PNG files, whatever the number of threads; z is what that 16-bit depth stands for. Throws nothing but what
// Options::progress throws (then nothing runs any more either). Several calls may run at once.
[[nodiscard]] DEPTHFARM_LIBRARY_API Result EstimateDepth(const Scene& scene, const Options& options = {});

// "0.1.0".
[[nodiscard]] DEPTHFARM_LIBRARY_API const char* Version();

}  // namespace depthfarm::library

#endif  // DEPTHFARM_COORDINATOR_LIBRARY_DEPTHFARM_H_
