#ifndef DEPTHFARM_COMMON_SEQUENCE_FRAME_NAME_H_
#define DEPTHFARM_COMMON_SEQUENCE_FRAME_NAME_H_

#include <string>

namespace depthfarm {

// `frame` >= 0 as the names of files have it: 4 digits or more, so that names sort as frames do.
[[nodiscard]] inline std::string FrameName(int frame) {
  std::string digits = std::to_string(frame);
  if (digits.size() < 4) digits.insert(0, 4 - digits.size(), '0');
  return digits;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_FRAME_NAME_H_
