#ifndef DEPTHFARM_COMMON_SEQUENCE_SEQUENCE_H_
#define DEPTHFARM_COMMON_SEQUENCE_SEQUENCE_H_

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/camera.h"

namespace depthfarm {

// How the file of a picture holds its samples.
struct PictureFormat {
  enum class Kind {
    kImage,   // of a kind that DecodeImage takes (common/media/image_codec.h)
    kYuv420,  // planar Y, Cb, Cr without a header, chroma of half width and height (rounded up)
    kYuv400,  // a Y plane without a header
    kYuv422,  // as kYuv420, chroma of half width and full height
    kYuv444,  // as kYuv420, chroma of full size
    kVideo,   // a coded video in a container (common/video_input/video_reader.h), of all frames
  };
  Kind kind = Kind::kImage;
  int bits = 8;  // raw kinds: 8, or 9..16 stored little-endian in two bytes
  // Raw kinds, and kVideo where `colour_said`: false = 16-235 / 16-240; false = BT.601.
  bool full_range = false;
  bool bt709 = false;
  // Raw kinds: the file holds all frames, one after the other without anything between them.
  bool all_frames = false;
  // kVideo: range and matrix are those of above, whatever the stream says of them.
  bool colour_said = false;
  // Planes without a header.
  [[nodiscard]] bool raw() const { return kind != Kind::kImage && kind != Kind::kVideo; }
  // Whether a file holds the pictures of all frames, that of frame f at position f.
  [[nodiscard]] bool of_all_frames() const { return all_frames || kind == Kind::kVideo; }
  bool operator==(const PictureFormat&) const = default;
};

// What files of prior depth hold: depth that comes from elsewhere (a scanner, a network, another program, a run
// before).
struct PriorFormat {
  enum class Holds {
    kNothing,        // the camera has no prior
    kDepth,          // value * unit = z along the camera's own axis, the sequence's unit of length
    kInverseDepth,   // value / unit = 1/z
    kRelativeDepth,  // of 1/z up to scale and shift, larger is nearer: what networks predict from one picture
    kCodes,          // 16-bit codes of the range z_near .. z_far (DepthCode): what this program writes
  };
  Holds holds = Holds::kNothing;
  double unit = 1;
  double z_near = 0;  // kCodes
  double z_far = 0;
  bool operator==(const PriorFormat&) const = default;
};

// One camera of a sequence and where its pictures are. Position f of every list is frame f.
struct SequenceCamera {
  Camera camera;
  PictureFormat format;
  // Absolute paths; empty = calibrated but without pictures: not estimated. The same for all frames where
  // format.of_all_frames().
  std::vector<std::string> images;
  std::vector<std::string> masks;  // absolute paths, optional; "": none for that frame. Grey: 0 background, full white
                                   // foreground
  std::vector<std::string> depth;  // absolute paths of supplied (estimated) depth, optional
  // Of --prior, absolute paths; "": none for that frame. Empty without a prior.
  PriorFormat prior_format;
  std::vector<std::string> prior;
  std::vector<std::string> prior_confidence;  // grey pictures, full white is certain
  std::optional<double> z_near;               // own range, the sequence's unit of length
  std::optional<double> z_far;
};

// Whether one of such lists names any file.
[[nodiscard]] inline bool AnyFile(const std::vector<std::string>& paths) {
  return std::any_of(paths.begin(), paths.end(), [](const std::string& path) { return !path.empty(); });
}

// Depth known for some views: rendered scenes and sets with measured disparity.
struct GroundTruthView {
  enum class Encoding {
    kDepthPfm,      // PFM float, z along the view's own axis; 0 = unknown
    kDisparityPfm,  // PFM float, z = scale / (value + offset)
    kDisparityPng,  // 8- or 16-bit grey, z = scale / (value / divisor), 0 = unknown
  };
  std::string view;
  Encoding encoding = Encoding::kDepthPfm;
  double scale = 1;   // the sequence's unit of length times pixels
  double offset = 0;  // pixels
  double divisor = 1;
  std::vector<std::string> depth;  // absolute path per frame
  std::vector<std::string> zones;  // absolute path per frame, 8-bit PNG of Zone values; may be empty
  std::string nonoccluded_mask;    // absolute path, 255 = counted; may be empty (cones, venus: nonocc.png)
};

// A calibrated multi-camera sequence as design section 2 describes it.
struct Sequence {
  std::string name;
  std::string file;  // the JSON file it came from, absolute
  std::optional<double> z_near;
  std::optional<double> z_far;
  double frame_rate = 0;  // 0 = unknown
  std::string reference;  // camera name, empty = the centre camera
  std::vector<SequenceCamera> cameras;
  std::vector<GroundTruthView> ground_truth;
  std::vector<std::string> warnings;  // sentences for the user: what was understood only in part, e.g. ground truth
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_SEQUENCE_H_
