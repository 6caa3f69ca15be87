#include "common/media/pfm.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>

#include "common/base/little_endian.h"
#include "common/files/atomic_file.h"

namespace depthfarm {
namespace {

constexpr int kMaxSide = 32768;
constexpr std::size_t kBytesPerValue = 4;
constexpr std::size_t kMaxHeaderBytes = 256;
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{kMaxSide} * kMaxSide * kBytesPerValue + kMaxHeaderBytes;

bool IsSpace(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

// The next word of the header and the one white-space character after it.
std::string_view TakeWord(std::string_view* rest) {
  while (!rest->empty() && IsSpace(rest->front())) rest->remove_prefix(1);
  std::size_t length = 0;
  while (length < rest->size() && length < kMaxHeaderBytes && !IsSpace((*rest)[length])) ++length;
  const std::string_view word = rest->substr(0, length);
  rest->remove_prefix(std::min(length + 1, rest->size()));
  return word;
}

template <typename T>
bool Parse(std::string_view word, T* value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), *value);
  return error == std::errc() && end == word.data() + word.size();
}

std::uint32_t LoadBits(const unsigned char* bytes, bool little_endian) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < kBytesPerValue; ++i) {
    bits = (bits << 8) | bytes[little_endian ? kBytesPerValue - 1 - i : i];
  }
  return bits;
}

}  // namespace

Result<Grid<float>> DecodePfm(std::string_view bytes) {
  std::string_view rest = bytes;
  const std::string_view magic = TakeWord(&rest);
  if (magic == "PF") return InvalidArgument("is a colour PFM, expected one channel (Pf)");
  if (magic != "Pf") return InvalidArgument("is not a PFM file, which begins with Pf");
  int width = 0;
  int height = 0;
  double scale = 0;
  const bool numbers =
      Parse(TakeWord(&rest), &width) && Parse(TakeWord(&rest), &height) && Parse(TakeWord(&rest), &scale);
  if (!numbers || width < 1 || height < 1 || width > kMaxSide || height > kMaxSide || !(scale < 0 || scale > 0)) {
    return InvalidArgument("has a bad PFM header, expected width and height from 1 to " + std::to_string(kMaxSide) +
                           " and a scale that is not 0");
  }
  const std::size_t expected = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * kBytesPerValue;
  if (rest.size() != expected) {
    return InvalidArgument("holds " + std::to_string(rest.size()) + " bytes of samples, expected " +
                           std::to_string(expected) + " for " + std::to_string(width) + "x" + std::to_string(height));
  }
  Grid<float> values(width, height);
  const auto* sample = reinterpret_cast<const unsigned char*>(rest.data());
  for (int y = height - 1; y >= 0; --y) {
    for (int x = 0; x < width; ++x, sample += kBytesPerValue) {
      values(x, y) = std::bit_cast<float>(LoadBits(sample, scale < 0));
    }
  }
  return values;
}

std::string EncodePfm(const Grid<float>& values) {
  std::string bytes = "Pf\n" + std::to_string(values.width()) + " " + std::to_string(values.height()) + "\n-1.0\n";
  bytes.reserve(bytes.size() + values.size() * kBytesPerValue);
  for (int y = values.height() - 1; y >= 0; --y) {
    for (int x = 0; x < values.width(); ++x) AppendU32(std::bit_cast<std::uint32_t>(values(x, y)), bytes);
  }
  return bytes;
}

Result<Grid<float>> ReadPfm(const std::string& path) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, ReadFileBytes(path, kMaxFileBytes));
  auto values = DecodePfm(bytes);
  if (!values.ok()) return values.status().WithContext(path);
  return values;
}

}  // namespace depthfarm
