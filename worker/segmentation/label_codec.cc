#include "worker/segmentation/label_codec.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "common/base/little_endian.h"
#include "worker/segmentation/explicit_labels.h"
#include "worker/segmentation/label_contexts.h"

namespace depthfarm {
namespace {

constexpr std::size_t kHeaderBytes = 4 * (kContexts.size() + 2);
constexpr std::size_t kMostPixelsPerByte = 8;
constexpr std::size_t kLeastPixelsPerByte = 4;

// Rules by context, and their bytes. Packs many at a time: a branch at every byte's last digit cannot be foreseen.
class RuleWriter {
 public:
  void Add(unsigned context, Rule rule) {
    std::uint32_t& size = sizes_[context];
    rules_[context][size++] = rule;
    if (size == kBuffered) Pack(context);
  }

  // All of the context's bytes; nothing is added to it after that.
  [[nodiscard]] const std::string& Finish(unsigned context) {
    if (sizes_[context] > 0) Pack(context);
    return bytes_[context];
  }

 private:
  static constexpr std::size_t kBuffered = 1000;  // whole bytes of each radix

  void Pack(unsigned context) {
    const ContextDigits& digits = kContextDigits[context];
    const std::array<Rule, kBuffered>& rules = rules_[context];
    const std::uint32_t size = std::exchange(sizes_[context], 0);
    for (std::uint32_t first = 0; first < size; first += digits.per_byte) {
      std::uint32_t byte = 0;
      for (std::uint32_t i = first; i < first + digits.per_byte; ++i)
        byte = byte * digits.radix + (i < size ? digits.digit_of[rules[i]] : 0U);
      bytes_[context].push_back(static_cast<char>(byte));
    }
  }

  std::array<std::array<Rule, kBuffered>, kContextNumbers> rules_;
  std::array<std::uint32_t, kContextNumbers> sizes_{};
  std::array<std::string, kContextNumbers> bytes_;
};

// The rules of each byte in order; of a byte that stands for none, the first is kNoRule.
constexpr Rule kNoRule{0xFF};
using UnpackedBytes = std::array<std::array<Rule, kMostPixelsPerByte>, 256>;

constexpr UnpackedBytes Unpacked(const ContextDigits& digits) {
  UnpackedBytes unpacked{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    for (std::uint32_t digit = digits.per_byte, rest = byte; digit-- > 0; rest /= digits.radix)
      unpacked[byte][digit] = digits.rule_of[rest % digits.radix];
    if (byte >= digits.values_of_byte) unpacked[byte][0] = kNoRule;
  }
  return unpacked;
}

// By which rules a context leaves out: bit 0 the other, bit 1 above right.
constexpr std::array<UnpackedBytes, 4> kUnpacked = {Unpacked(DigitsOf(0)), Unpacked(DigitsOf(1)), Unpacked(DigitsOf(8)),
                                                    Unpacked(DigitsOf(31))};

class RuleReader {
 public:
  // False: these are not the bytes of that many pixels.
  [[nodiscard]] bool Unpack(const std::array<std::string_view, kContexts.size()>& bytes, std::size_t pixels) {
    std::uint64_t digits = 0;
    for (std::size_t i = 0; i < kContexts.size(); ++i)
      digits += std::uint64_t{bytes[i].size()} * kContextDigits[kContexts[i]].per_byte;
    // A last byte has one pixel at least.
    if (digits < pixels || digits >= pixels + kMostPixelsPerByte * kContexts.size()) return false;
    rules_.resize(digits + kContexts.size() + kMostPixelsPerByte);
    Rule* to = rules_.data();
    for (std::size_t i = 0; i < kContexts.size(); ++i) {
      const unsigned context = kContexts[i];
      const ContextDigits& of = kContextDigits[context];
      const UnpackedBytes& unpacked = kUnpacked[(of.both_equal ? 1U : 0U) | (of.right_is_new ? 0U : 2U)];
      next_[context] = to;
      for (const char byte : bytes[i]) {
        const auto& rules = unpacked[static_cast<std::uint8_t>(byte)];
        if (rules[0] == kNoRule) return false;
        std::copy(rules.begin(), rules.end(), to);  // beyond these, what the next overwrites
        to += of.per_byte;
      }
      *to++ = kNoRule;
    }
    return true;
  }

  // kNoRule: the context has no further one; none may be asked for after that.
  [[nodiscard]] Rule Next(unsigned context) { return *next_[context]++; }

  // All are taken but those that fill up a byte.
  [[nodiscard]] bool done() const {
    return std::all_of(kContexts.begin(), kContexts.end(), [this](unsigned context) {
      const Rule* rule = next_[context];
      while (*rule == kLikelier) ++rule;
      return *rule == kNoRule && rule - next_[context] < static_cast<std::ptrdiff_t>(kContextDigits[context].per_byte);
    });
  }

 private:
  std::vector<Rule> rules_;
  std::array<const Rule*, kContextNumbers> next_{};
};

// The parts of a map's bytes.
struct Parts {
  std::array<std::string_view, kContexts.size()> rules;
  std::string_view table;
  std::string_view codes;
  std::string_view plain;
};

Result<Parts> Split(std::string_view bytes, std::size_t pixels) {
  const auto wrong = [&bytes](const std::string& what) {
    return Corrupt("label map of " + std::to_string(bytes.size()) + " bytes: " + what);
  };
  if (bytes.size() < LeastLabelBytes(pixels)) {
    return wrong("expected at least " + std::to_string(LeastLabelBytes(pixels)) + " for " + std::to_string(pixels) +
                 " pixels");
  }
  std::array<std::uint32_t, kContexts.size() + 2> sizes{};
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = ReadU32(bytes, 4 * i);
  std::string_view rest = bytes.substr(kHeaderBytes);
  bool fits = true;
  const auto take = [&](std::uint64_t size) {
    fits = fits && size <= rest.size();
    const std::string_view part = rest.substr(0, fits ? size : 0);
    rest.remove_prefix(part.size());
    return part;
  };
  Parts parts;
  for (std::size_t i = 0; i < kContexts.size(); ++i) parts.rules[i] = take(sizes[i]);
  const std::uint32_t num_explicit = sizes[kContexts.size()];
  const std::uint32_t num_table = sizes[kContexts.size() + 1];
  if (num_table > kMaxTable) return wrong("a table of " + std::to_string(num_table) + " differences");
  parts.table = take(4 * std::uint64_t{num_table});
  parts.codes = take(num_explicit);
  if (!fits) return wrong("its parts are larger");
  parts.plain = rest;
  return parts;
}

}  // namespace

std::size_t LeastLabelBytes(std::size_t pixels) {
  return kHeaderBytes + (pixels + kMostPixelsPerByte - 1) / kMostPixelsPerByte;
}

std::size_t MostLabelBytes(std::size_t pixels) {
  return kHeaderBytes + pixels / kLeastPixelsPerByte + kContexts.size() + 4 * kMaxTable + 5 * pixels;
}

void AppendLabels(const Grid<SegmentIndex>& labels, std::string& bytes, std::vector<std::size_t>& cuts) {
  RuleWriter rules;
  ExplicitLabels explicit_labels;
  const int width = labels.width();
  const std::vector<SegmentIndex> outside(static_cast<std::size_t>(width), 0);
  for (int y = 0; y < labels.height(); ++y) {
    const SegmentIndex* const row = labels.row(y);
    const SegmentIndex* const above_row = y > 0 ? labels.row(y - 1) : outside.data();
    LabelsAround around;
    around.above = above_row[0];
    for (int x = 0; x < width; ++x) {
      around.above_right = x + 1 < width ? above_row[x + 1] : 0;
      const SegmentIndex label = row[x];
      Rule rule = label == around.above_right ? kAboveRight : kExplicit;
      if (label == around.other()) rule = kOther;
      if (label == around.likelier()) rule = kLikelier;
      rules.Add(around.Context(), rule);
      if (rule == kExplicit) explicit_labels.Add(label, y > 0 ? around.above : around.left);
      around = {.left = label, .above_left = around.above, .above = around.above_right};
    }
  }

  const ExplicitLabels::Coded coded = explicit_labels.Code();
  for (const unsigned context : kContexts) AppendU32(static_cast<std::uint32_t>(rules.Finish(context).size()), bytes);
  AppendU32(static_cast<std::uint32_t>(coded.codes.size()), bytes);
  AppendU32(static_cast<std::uint32_t>(coded.table.size()), bytes);
  for (const unsigned context : kContexts) {
    cuts.push_back(bytes.size());
    bytes += rules.Finish(context);
  }
  cuts.push_back(bytes.size());
  for (const std::uint32_t difference : coded.table) AppendU32(difference, bytes);
  cuts.push_back(bytes.size());
  bytes += coded.codes;
  cuts.push_back(bytes.size());
  for (const SegmentIndex label : coded.plain) AppendU32(label, bytes);
}

Result<Grid<SegmentIndex>> ReadLabels(std::string_view bytes, int width, int height, SegmentIndex num_segments) {
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  DEPTHFARM_ASSIGN_OR_RETURN(Parts parts, Split(bytes, pixels));
  if (num_segments == 0) return Corrupt("label map of no segments");
  RuleReader rules;
  if (!rules.Unpack(parts.rules, pixels)) return Corrupt("label map has not one rule for each of its pixels");
  ExplicitLabelReader explicit_labels(parts.table, parts.codes, parts.plain);
  const std::vector<SegmentIndex> outside(static_cast<std::size_t>(width), 0);
  Grid<SegmentIndex> labels(width, height);
  for (int y = 0; y < height; ++y) {
    SegmentIndex* const row = labels.row(y);
    const SegmentIndex* const above_row = y > 0 ? labels.row(y - 1) : outside.data();
    LabelsAround around;
    around.above = above_row[0];
    for (int x = 0; x < width; ++x) {
      around.above_right = x + 1 < width ? above_row[x + 1] : 0;
      const Rule rule = rules.Next(around.Context());
      SegmentIndex label = around.Follow(rule);
      if (rule >= kExplicit) {
        const auto told = rule == kExplicit ? explicit_labels.Next(y > 0 ? around.above : around.left) : std::nullopt;
        if (!told || *told >= num_segments) {
          return Corrupt("label at (" + std::to_string(x) + ", " + std::to_string(y) +
                         ") is unreadable or outside 0 to " + std::to_string(std::int64_t{num_segments} - 1));
        }
        label = *told;
      }
      row[x] = label;
      around = {.left = label, .above_left = around.above, .above = around.above_right};
    }
  }
  if (!rules.done() || !explicit_labels.done()) return Corrupt("label map has more than its labels");
  return labels;
}

}  // namespace depthfarm
