#ifndef DEPTHFARM_COMMON_SCENE_HASH_H_
#define DEPTHFARM_COMMON_SCENE_HASH_H_

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

namespace depthfarm {

// Counter-based randomness: a number is a function of a key and a counter, so that any frame, pixel or object can be
// made alone and in any order (std::random's distributions differ between libraries and need their history).

// Mixes 64 bits so that each input bit flips each output bit about half of the time (the finaliser of SplitMix64).
[[nodiscard]] constexpr std::uint64_t Mix(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15ULL;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31);
}

// A key derived from another one, e.g. that of a camera from that of the scene.
[[nodiscard]] constexpr std::uint64_t DerivedKey(std::uint64_t key, std::uint64_t counter) {
  return Mix(Mix(key) ^ counter);
}
[[nodiscard]] constexpr std::uint64_t DerivedKey(std::uint64_t key, std::string_view name) {
  for (const char letter : name) key = DerivedKey(key, static_cast<unsigned char>(letter));
  return DerivedKey(key, name.size());
}

// Uniform in [0, 1), from the top 53 bits.
[[nodiscard]] constexpr double Uniform(std::uint64_t key, std::uint64_t counter) {
  return static_cast<double>(DerivedKey(key, counter) >> 11) * 0x1.0p-53;
}
// Uniform in [low, high).
[[nodiscard]] constexpr double Uniform(std::uint64_t key, std::uint64_t counter, double low, double high) {
  return low + (high - low) * Uniform(key, counter);
}

struct NormalPair {
  double first = 0;
  double second = 0;
};
// Two independent values of mean 0 and standard deviation 1 (Box and Muller).
[[nodiscard]] inline NormalPair Normals(std::uint64_t key, std::uint64_t counter) {
  const std::uint64_t bits = DerivedKey(key, counter);
  const double radius = std::sqrt(-2.0 * std::log((static_cast<double>(bits >> 32) + 0.5) * 0x1.0p-32));
  const double angle = 2.0 * std::numbers::pi * static_cast<double>(bits & 0xffffffffULL) * 0x1.0p-32;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SCENE_HASH_H_
