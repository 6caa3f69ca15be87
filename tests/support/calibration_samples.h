#ifndef DEPTHFARM_TESTS_SUPPORT_CALIBRATION_SAMPLES_H_
#define DEPTHFARM_TESTS_SUPPORT_CALIBRATION_SAMPLES_H_

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/little_endian.h"

namespace depthfarm::samples {

// Small files of the formats that `depthfarm import` reads, made up. But for msr and miv they are of one rig: "left" at
// the origin, looking along z, and "right" at (2, 0, 1), turned by -36.9 degrees about y; x_cam = R X + t with
//
//   R = | 0.8 0 -0.6 |   t = (-1, 0, -2)
//       | 0   1  0   |
//       | 0.6 0  0.8 |

inline constexpr std::string_view kFtv = R"(# two cameras
left
500 0 319.5
0 510 239.5
0 0 1
0
0
1 0 0 0
0 1 0 0
0 0 1 0

right
500.0	0.5	300
0.0	510.0	240
0.0	0.0	1.0
0.0	0.0
0.8	0.0	-0.6	2.0
0.0	1.0	0.0	0.0
0.6	0.0	0.8	1e0
)";

// Turned about x, so that the change of y shows.
inline constexpr std::string_view kMsr =
    "0\r\n500 0 319.5\r\n0 510 239.5\r\n0 0 1\r\n0 0\r\n1 0 0 0\r\n0 1 0 0\r\n0 0 1 0\r\n\r\n"
    "1\r\n500 0.5 300\r\n0 510 240\r\n0 0 1\r\n0 0\r\n1 0 0 3\r\n0 0.8 -0.6 4\r\n0 0.6 0.8 5\r\n";

inline constexpr std::string_view kMiddlebury =
    "2\n"
    "left.png 500 0 319.5 0 510 239.5 0 0 1 1 0 0 0 1 0 0 0 1 0 0 0\n"
    "right.png 500 0.5 300 0 510 240 0 0 1 0.8 0 -0.6 0 1 0 0.6 0 0.8 -1 0 -2\n";

// v1 is turned a quarter to the left, v2 looks down, v3 is turned about its axis.
inline constexpr std::string_view kMiv = R"({"Version": "4.0", "Content_name": "made up", "Fps": 30, "Frames_number": 2,
 "cameras": [
  {"Name": "v0", "Position": [0, 0, 0], "Rotation": [0, 0, 0], "Depth_range": [2, 9.5], "Resolution": [640, 480],
   "Projection": "Perspective", "Focal": [500, 510], "Principle_point": [320, 240], "BitDepthColor": 10},
  {"Name": "v1", "Position": [1, 2, 3], "Rotation": [90, 0, 0], "Depth_range": [2, 9.5], "Resolution": [640, 480],
   "Projection": "Perspective", "Focal": [500, 510], "Principle_point": [320, 240], "BitDepthColor": 10},
  {"Name": "v2", "Position": [0, 0, 1], "Rotation": [0, 90, 0], "Depth_range": [2, 1000], "Resolution": [640, 480],
   "Projection": "Perspective", "Focal": [500, 510], "Principle_point": [320, 240]},
  {"Name": "v3", "Position": [0, 0, 0], "Rotation": [0, 0, 90], "Depth_range": [2, 9.5], "Resolution": [640, 480],
   "Projection": "Perspective", "Focal": [500, 510], "Principle_point": [320, 240]},
  {"Name": "viewport", "Position": [0, 0, 0], "Rotation": [0, 0, 0], "Depth_range": [2, 9.5], "Resolution": [64, 64],
   "Projection": "Equirectangular", "Hor_range": [-180, 180], "Ver_range": [-90, 90]}]})";

inline void AppendDouble(double number, std::string& bytes) { AppendU64(std::bit_cast<std::uint64_t>(number), bytes); }

// A NumPy file of version 1 with this dictionary and these numbers.
inline std::string Npy(const std::string& dictionary, const std::vector<double>& numbers) {
  const std::string header = dictionary + "\n";
  std::string bytes = "\x93NUMPY\x01";
  bytes += '\0';
  bytes += static_cast<char>(header.size() & 0xFFU);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  for (const double number : numbers) AppendDouble(number, bytes);
  return bytes;
}

// Rows of poses_bounds.npy: down, right, backwards, centre, size and focal length; near, far.
inline const std::vector<double>& LlffNumbers() {
  static const std::vector<double> numbers = {
      0, 1,   0,    0, 480, 1, 0, 0, 0, 640, 0, 0,    -1,   0, 500, 2,   9,  //
      0, 0.8, -0.6, 2, 480, 1, 0, 0, 0, 640, 0, -0.6, -0.8, 1, 500, 2.5, 9.5,
  };
  return numbers;
}
inline std::string Llff() { return Npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 17), }", LlffNumbers()); }

inline constexpr std::string_view kColmapCameras =
    "# Camera list\n1 SIMPLE_PINHOLE 640 480 500 320 240\n7 OPENCV 640 480 500 510 300.5 240.5 0 0 0 0\n";
inline constexpr std::string_view kColmapImages =
    "# Image list\n"
    "4 0.9486832980505138 0 -0.31622776601683794 0 -1 0 -2 7 rig/right.jpg\n"
    "320 240 0 100.5 7 -1\n"
    "2 1 0 0 0 0 0 0 1 rig/left.jpg\n"
    "\n";

// Points on the axis of "left", at depths 4, 5, 6, ..., which both see.
inline constexpr int kColmapPointCount = 24;
inline std::string ColmapPoints() {
  std::string text = "# 3D point list\n";
  for (int i = 0; i < kColmapPointCount; ++i)
    text += std::to_string(i) + " 0 0 " + std::to_string(4 + i) + " 9 8 7 0.5 2 0 4 " + std::to_string(i) + "\n";
  return text;
}

inline std::string ColmapCamerasBinary() {
  std::string bytes;
  AppendU64(2, bytes);
  for (const int camera : {1, 7}) {
    AppendU32(static_cast<std::uint32_t>(camera), bytes);
    AppendU32(camera == 1 ? 0 : 4, bytes);
    AppendU64(640, bytes);
    AppendU64(480, bytes);
    const std::vector<double> simple = {500, 320, 240};
    const std::vector<double> opencv = {500, 510, 300.5, 240.5, 0, 0, 0, 0};
    for (const double number : camera == 1 ? simple : opencv) AppendDouble(number, bytes);
  }
  return bytes;
}
inline std::string ColmapImagesBinary() {
  std::string bytes;
  AppendU64(2, bytes);
  for (const int image : {4, 2}) {
    AppendU32(static_cast<std::uint32_t>(image), bytes);
    const std::vector<double> right = {0.9486832980505138, 0, -0.31622776601683794, 0, -1, 0, -2};
    const std::vector<double> left = {1, 0, 0, 0, 0, 0, 0};
    for (const double number : image == 4 ? right : left) AppendDouble(number, bytes);
    AppendU32(image == 4 ? 7 : 1, bytes);
    bytes += image == 4 ? "rig/right.jpg" : "rig/left.jpg";
    bytes += '\0';
    AppendU64(image == 4 ? 1 : 0, bytes);
    if (image == 4) bytes += std::string(24, '\x01');
  }
  return bytes;
}
inline std::string ColmapPointsBinary() {
  std::string bytes;
  AppendU64(kColmapPointCount, bytes);
  for (int i = 0; i < kColmapPointCount; ++i) {
    AppendU64(static_cast<std::uint64_t>(i), bytes);
    for (const double number : {0.0, 0.0, 4.0 + i}) AppendDouble(number, bytes);
    bytes += "rgb";
    AppendDouble(0.5, bytes);
    AppendU64(2, bytes);
    for (const std::uint32_t image : {2U, 4U}) {
      AppendU32(image, bytes);
      AppendU32(0, bytes);
    }
  }
  return bytes;
}

}  // namespace depthfarm::samples

#endif  // DEPTHFARM_TESTS_SUPPORT_CALIBRATION_SAMPLES_H_
