#include "common/video/handles.h"

#include <array>

namespace depthfarm {

Status AvFailure(const std::string& what, int error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text = {};
  av_strerror(error, text.data(), text.size());
  return Internal(what + ": " + text.data());
}

}  // namespace depthfarm
