#include "common/text/clean_line.h"

#include <algorithm>
#include <cstdint>

namespace depthfarm {
namespace {

// Bytes of the well-formed UTF-8 character at the beginning of `text`; 0 when there is none.
std::size_t CharacterBytes(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t count = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < count) return 0;
  std::uint32_t code = first & (0x7fU >> count);
  for (std::size_t i = 1; i < count; ++i) {
    if ((byte(i) & 0xc0U) != 0x80U) return 0;
    code = (code << 6U) | (byte(i) & 0x3fU);
  }
  const bool overlong = (count == 3 && code < 0x800) || (count == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return overlong || surrogate || code > 0x10ffff ? 0 : count;
}

}  // namespace

std::string CleanLine(std::string_view text, std::size_t max_bytes) {
  constexpr std::string_view kCut = "...";
  const std::size_t room = max_bytes < kCut.size() ? 0 : max_bytes - kCut.size();
  std::string line;
  std::size_t uncut = 0;  // bytes of the line that are kept if it is cut
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t count = CharacterBytes(text.substr(at));
    const auto byte = static_cast<unsigned char>(text[at]);
    if (count > 1) {
      line += text.substr(at, count);
    } else if (count == 1 && byte >= 0x20 && byte != 0x7f) {
      line += text[at];
    } else {
      line += byte == '\t' ? ' ' : '?';
    }
    at += std::max<std::size_t>(count, 1);
    if (line.size() <= room) uncut = line.size();
    if (line.size() <= max_bytes) continue;
    line.resize(uncut);
    return line + std::string(kCut.substr(0, max_bytes));
  }
  return line;
}

}  // namespace depthfarm
