#ifndef DEPTHFARM_COMMON_CALIBRATION_PICTURE_NAME_H_
#define DEPTHFARM_COMMON_CALIBRATION_PICTURE_NAME_H_

#include <string>
#include <string_view>

namespace depthfarm {

enum class KeepEnding { kNo, kYes };

// The camera of a picture by its name: "left/0001.jpg" -> "left_0001". The ending goes unless it is kept; what no name
// of a camera may have, '/' and "..", becomes '_'.
[[nodiscard]] std::string NameOfPicture(std::string_view picture, KeepEnding ending = KeepEnding::kNo);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_PICTURE_NAME_H_
