#include "common/sequence/output_layout.h"

#include <filesystem>

#include "common/sequence/json_fields.h"

namespace depthfarm {

bool StaysInFolder(const std::string& path) {
  if (path.empty() || HasControlCharacter(path)) return false;
  const std::filesystem::path normal = std::filesystem::path(path).lexically_normal();
  return normal == std::filesystem::path(path) && normal.is_relative() && *normal.begin() != ".." &&
         normal.has_filename() && normal != ".";
}

}  // namespace depthfarm
