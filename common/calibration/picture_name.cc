#include "common/calibration/picture_name.h"

namespace depthfarm {

std::string NameOfPicture(std::string_view picture, KeepEnding ending) {
  const std::size_t file = picture.rfind('/') == std::string_view::npos ? 0 : picture.rfind('/') + 1;
  const std::size_t dot = picture.rfind('.');
  const bool cut = ending == KeepEnding::kNo && dot != std::string_view::npos && dot > file;
  std::string name(cut ? picture.substr(0, dot) : picture);
  for (char& c : name)
    if (c == '/') c = '_';
  for (std::size_t at = name.find(".."); at != std::string::npos; at = name.find("..")) name.replace(at, 2, "_");
  return name;
}

}  // namespace depthfarm
