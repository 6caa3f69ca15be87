#include "common/sequence/depth_format.h"

#include <algorithm>
#include <array>

namespace depthfarm {
namespace {

struct Entry {
  DepthFormat format;
  std::string_view name;
  std::string_view extension;
};

constexpr std::array kFormats{Entry{DepthFormat::kPng16, "png16", "png"}, Entry{DepthFormat::kPfm, "pfm", "pfm"},
                              Entry{DepthFormat::kExr, "exr", "exr"},
                              Entry{DepthFormat::kYuv420p16, "yuv420p16", "yuv"}};

const Entry& EntryOf(DepthFormat format) { return *std::ranges::find(kFormats, format, &Entry::format); }

}  // namespace

std::string_view NameOf(DepthFormat format) { return EntryOf(format).name; }

std::optional<DepthFormat> DepthFormatOfName(std::string_view name) {
  const auto* const found = std::ranges::find(kFormats, name, &Entry::name);
  return found == kFormats.end() ? std::nullopt : std::optional(found->format);
}

std::string_view DepthFormatNames() { return "png16, pfm, exr or yuv420p16"; }

std::string ExtensionOf(DepthFormat format) { return std::string(EntryOf(format).extension); }

std::optional<DepthFormat> DepthFormatOfFile(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  const auto* const found = std::ranges::find(kFormats, path.substr(dot + 1), &Entry::extension);
  return found == kFormats.end() ? std::nullopt : std::optional(found->format);
}

}  // namespace depthfarm
