#ifndef DEPTHFARM_WORKER_SEGMENTATION_LABEL_CONTEXTS_H_
#define DEPTHFARM_WORKER_SEGMENTATION_LABEL_CONTEXTS_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// How a label may follow from those before it (label_codec.h).
enum Rule : std::uint8_t { kLikelier = 0, kOther = 1, kAboveRight = 2, kExplicit = 3 };
inline constexpr std::size_t kNumRules = 4;

// The labels around a pixel that come before its own; outside the map they are 0.
struct LabelsAround {
  SegmentIndex left = 0;
  SegmentIndex above_left = 0;
  SegmentIndex above = 0;
  SegmentIndex above_right = 0;

  // A border that ran between above left and above goes on downwards; one that ran between above left and left goes
  // right.
  [[nodiscard]] SegmentIndex likelier() const { return left == above_left ? above : left; }
  [[nodiscard]] SegmentIndex other() const { return left == above_left ? left : above; }

  // The label that a rule but kExplicit gives.
  [[nodiscard]] SegmentIndex Follow(Rule rule) const {
    if (rule == kLikelier) return likelier();
    return rule == kOther ? other() : above_right;
  }

  // Which of them are equal, as bits.
  [[nodiscard]] unsigned Context() const {
    return static_cast<unsigned>(left == above) | static_cast<unsigned>(left == above_left) << 1U |
           static_cast<unsigned>(above == above_left) << 2U | static_cast<unsigned>(above_right == above) << 3U |
           static_cast<unsigned>(above_right == left) << 4U;
  }
};

inline constexpr std::size_t kContextNumbers = 32;
// The contexts that occur: equality is transitive.
inline constexpr std::array<std::uint8_t, 13> kContexts = {0, 1, 2, 4, 7, 8, 10, 12, 16, 18, 20, 25, 31};

// The rules of one context as digits.
struct ContextDigits {
  bool both_equal = false;           // left and above: there is no other
  bool right_is_new = false;         // else above right is one of those two
  std::uint32_t radix = 0;           // 2 to 4
  std::uint32_t per_byte = 0;        // digits
  std::uint32_t values_of_byte = 0;  // radix to the power of per_byte
  std::array<std::uint8_t, kNumRules> digit_of{};
  std::array<Rule, kNumRules> rule_of{};  // of each digit below the radix
};

constexpr ContextDigits DigitsOf(unsigned context) {
  ContextDigits digits;
  digits.both_equal = (context & 1U) != 0;
  digits.right_is_new = (context & 24U) == 0;
  for (const Rule rule : {kLikelier, kOther, kAboveRight, kExplicit}) {
    if ((rule == kOther && digits.both_equal) || (rule == kAboveRight && !digits.right_is_new)) continue;
    digits.rule_of[digits.radix] = rule;
    digits.digit_of[rule] = static_cast<std::uint8_t>(digits.radix++);
  }
  digits.per_byte = digits.radix == 2 ? 8 : digits.radix == 3 ? 5 : 4;
  digits.values_of_byte = digits.radix == 3 ? 243 : 256;
  return digits;
}

inline constexpr std::array<ContextDigits, kContextNumbers> kContextDigits = [] {
  std::array<ContextDigits, kContextNumbers> digits;
  for (unsigned context = 0; context < kContextNumbers; ++context) digits[context] = DigitsOf(context);
  return digits;
}();

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_LABEL_CONTEXTS_H_
