#ifndef DEPTHFARM_COORDINATOR_IMPORTING_IMPORT_OPTIONS_H_
#define DEPTHFARM_COORDINATOR_IMPORTING_IMPORT_OPTIONS_H_

#include <optional>
#include <string>
#include <vector>

namespace depthfarm {

// What `depthfarm import` was asked for, in the words of its options; "" or nothing: not said.
struct ImportOptions {
  std::string format;       // "ftv", "msr", "colmap", "miv", "llff", "middlebury"
  std::string calibration;  // file; colmap: folder
  std::string output;       // sequence file
  std::string images;       // see PicturePattern, or a folder
  std::string videos;       // see PicturePattern: a file of all frames for each camera
  std::string frames;       // "A:B"
  std::string size;         // "WxH"
  std::string pixel_format;
  std::string range;                 // "limited", "full"
  std::string matrix;                // "bt601", "bt709"
  std::vector<std::string> cameras;  // empty: all
  std::string reference;
  std::string name;
  std::optional<double> z_near;
  std::optional<double> z_far;
  std::string pose;    // ftv: "centre", "camera-to-world", "world-to-camera"
  std::string z_axis;  // ftv: "forward", "backward"
  bool allow_missing = false;
  bool allow_outside = false;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_IMPORTING_IMPORT_OPTIONS_H_
