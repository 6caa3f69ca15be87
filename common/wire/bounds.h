#ifndef DEPTHFARM_COMMON_WIRE_BOUNDS_H_
#define DEPTHFARM_COMMON_WIRE_BOUNDS_H_

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// Bounds of what a peer may send. All checks return kInvalidArgument with the name of the field, the value and the
// bound.
inline constexpr int kMaxViews = 1024;
inline constexpr int kMaxFrames = 10'000'000;
inline constexpr int kMaxInputs = 4 * kMaxViews;
inline constexpr int kMaxPathBytes = 4096;
inline constexpr int kMaxNameBytes = 200;
inline constexpr int kMaxWorkerSlots = 1024;  // and tasks taken ahead
inline constexpr int kMaxTags = 32;           // of a worker, or asked for by a job
inline constexpr int kMaxTagBytes = 64;
inline constexpr int kMaxLocations = 64;
inline constexpr std::size_t kMaxTaskLogLines = 64;
inline constexpr std::size_t kMaxTaskLogBytes = 16384;  // of all lines
inline constexpr std::size_t kMaxTaskLogLineBytes = 2048;
inline constexpr std::size_t kMaxDeathBytes = 200;  // of how a worker died
inline constexpr std::uint64_t kMaxArtifactBytes = std::uint64_t{1} << 36;

// `value` as an int of [0, max].
[[nodiscard]] Result<int> BoundedInt(std::string_view field, std::uint64_t value, int max);
[[nodiscard]] Status CheckCount(std::string_view field, std::int64_t count, std::int64_t max);
[[nodiscard]] Status CheckFinite(std::string_view field, double value);
// Absolute, at most 4096 bytes, no NUL.
[[nodiscard]] Status CheckAbsolutePath(std::string_view field, std::string_view path);
// A name that can be one component of a path: not empty, ".", "..", no '/', no control characters, at most 200 bytes.
[[nodiscard]] Status CheckFileName(std::string_view field, std::string_view name);
// Text for people: at most `max_bytes`, no control characters.
[[nodiscard]] Status CheckText(std::string_view field, std::string_view text, std::int64_t max_bytes);

// Of a worker or a job: at most kMaxTags of 1 to kMaxTagBytes letters, digits, '-', '_', '.', ':'; without repeats.
[[nodiscard]] Result<std::set<std::string>> CheckTags(std::string_view field, const std::vector<std::string>& tags);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_WIRE_BOUNDS_H_
