#ifndef DEPTHFARM_COMMON_BASE_STRONG_ID_H_
#define DEPTHFARM_COMMON_BASE_STRONG_ID_H_

#include <compare>
#include <cstddef>
#include <functional>

namespace depthfarm {

// An identifier that cannot be mixed up with another kind or with a count: using TaskId = StrongId<struct TaskIdTag,
// uint64_t>.
template <typename Tag, typename Rep>
class StrongId {
 public:
  constexpr StrongId() = default;
  constexpr explicit StrongId(Rep value) : value_(value) {}
  [[nodiscard]] constexpr Rep value() const { return value_; }
  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 takes the 0 of a defaulted <=> for a pointer
  constexpr auto operator<=>(const StrongId&) const = default;

 private:
  Rep value_{};
};

}  // namespace depthfarm

template <typename Tag, typename Rep>
struct std::hash<depthfarm::StrongId<Tag, Rep>> {
  std::size_t operator()(depthfarm::StrongId<Tag, Rep> id) const noexcept { return std::hash<Rep>{}(id.value()); }
};

#endif  // DEPTHFARM_COMMON_BASE_STRONG_ID_H_
