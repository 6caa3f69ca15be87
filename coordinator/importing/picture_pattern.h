#ifndef DEPTHFARM_COORDINATOR_IMPORTING_PICTURE_PATTERN_H_
#define DEPTHFARM_COORDINATOR_IMPORTING_PICTURE_PATTERN_H_

#include <string>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// Where the pictures of cameras are, as a path with {camera}, its name, {number}, the number that ends its name without
// zeros before it (cam03: 3), and {frame}; both numbers also with at least so many digits, {frame:04}.
class PicturePattern {
 public:
  // kInvalidArgument, naming the pattern: anything else in braces, or braces that do not close.
  [[nodiscard]] static Result<PicturePattern> Parse(const std::string& text);

  // Whether `text` is to be read as a pattern at all, and not as a folder.
  [[nodiscard]] static bool IsPattern(const std::string& text) { return text.find('{') != std::string::npos; }

  [[nodiscard]] bool has_frames() const { return Has(Part::Kind::kFrame); }
  [[nodiscard]] bool tells_cameras_apart() const { return Has(Part::Kind::kCamera) || Has(Part::Kind::kNumber); }
  // The path for a camera and frame (>= 0). kInvalidArgument: {number} of a name that ends in no number.
  [[nodiscard]] Result<std::string> PathOf(const std::string& camera, int frame) const;

 private:
  struct Part {
    enum class Kind { kText, kCamera, kNumber, kFrame };
    Kind kind = Kind::kText;
    std::string text;        // kText
    std::size_t digits = 1;  // at least, of kNumber and kFrame
  };
  [[nodiscard]] static bool ParseField(const std::string& field, Part& part);
  [[nodiscard]] bool Has(Part::Kind kind) const;

  std::string text_;
  std::vector<Part> parts_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_IMPORTING_PICTURE_PATTERN_H_
