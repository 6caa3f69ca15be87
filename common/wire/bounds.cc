#include "common/wire/bounds.h"

#include <algorithm>
#include <cmath>

namespace depthfarm {
namespace {

bool HasControl(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

Status Bad(std::string_view field, const std::string& what) { return InvalidArgument(std::string(field) + " " + what); }

}  // namespace

Result<int> BoundedInt(std::string_view field, std::uint64_t value, int max) {
  if (value > static_cast<std::uint64_t>(max)) {
    return Bad(field, "is " + std::to_string(value) + ", expected at most " + std::to_string(max));
  }
  return static_cast<int>(value);
}

Status CheckCount(std::string_view field, std::int64_t count, std::int64_t max) {
  if (count <= max) return {};
  return Bad(field, "has " + std::to_string(count) + " entries, expected at most " + std::to_string(max));
}

Status CheckFinite(std::string_view field, double value) {
  if (std::isfinite(value)) return {};
  return Bad(field, "is not a finite number");
}

Status CheckAbsolutePath(std::string_view field, std::string_view path) {
  if (path.size() > kMaxPathBytes) {
    return Bad(field,
               "has " + std::to_string(path.size()) + " bytes, expected at most " + std::to_string(kMaxPathBytes));
  }
  if (path.empty() || path[0] != '/') return Bad(field, "is '" + std::string(path) + "', expected an absolute path");
  if (path.find('\0') != std::string_view::npos) return Bad(field, "holds a NUL byte");
  return {};
}

Status CheckFileName(std::string_view field, std::string_view name) {
  if (name.empty()) return Bad(field, "is empty");
  DEPTHFARM_RETURN_IF_ERROR(CheckText(field, name, kMaxNameBytes));
  if (name == "." || name == ".." || name.find('/') != std::string_view::npos) {
    return Bad(field, "is '" + std::string(name) + "', expected a name that can be a file name");
  }
  return {};
}

Status CheckText(std::string_view field, std::string_view text, std::int64_t max_bytes) {
  if (static_cast<std::int64_t>(text.size()) > max_bytes) {
    return Bad(field, "has " + std::to_string(text.size()) + " bytes, expected at most " + std::to_string(max_bytes));
  }
  if (HasControl(text)) return Bad(field, "holds a control character");
  return {};
}

Result<std::set<std::string>> CheckTags(std::string_view field, const std::vector<std::string>& tags) {
  DEPTHFARM_RETURN_IF_ERROR(CheckCount(field, static_cast<std::int64_t>(tags.size()), kMaxTags));
  std::set<std::string> checked;
  for (const std::string& tag : tags) {
    DEPTHFARM_RETURN_IF_ERROR(CheckText(field, tag, kMaxTagBytes));
    const bool legal = !tag.empty() && std::ranges::all_of(tag, [](unsigned char c) {
      return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_' ||
             c == '.' || c == ':';
    });
    if (!legal) return Bad(field, "has '" + tag + "', expected letters, digits, '-', '_', '.' and ':'");
    if (!checked.insert(tag).second) return Bad(field, "has '" + tag + "' twice");
  }
  return checked;
}

}  // namespace depthfarm
