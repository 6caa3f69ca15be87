#include "worker/segmentation/label_codec.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "common/base/little_endian.h"
#include "worker/segmentation/explicit_labels.h"
#include "worker/segmentation/label_contexts.h"

namespace depthfarm {
namespace {

constexpr std::size_t kHeaderBytes = 4 * (kContexts.size() + 2);
constexpr std::size_t kMostPixelsPerByte = 8;
constexpr std::size_t kLeastPixelsPerByte = 4;

// What FindRules tells of a pixel: its context, and above that the rule that gives its label.
constexpr unsigned kContextBits = 5;
static_assert(kContextNumbers == 1U << kContextBits);
constexpr std::uint8_t kFirstExplicit = kExplicit << kContextBits;

// Rules by context, and their bytes. Packs many at a time: a branch at every byte's last digit cannot be foreseen.
class RuleWriter {
 public:
  // Of pixels in their order.
  void Add(std::span<const std::uint8_t> followed) {
    for (; followed.size() > kPiece; followed = followed.subspan(kPiece)) AddPiece(followed.first(kPiece));
    AddPiece(followed);
  }

  // All of the context's bytes; nothing is added to it after that.
  [[nodiscard]] const std::string& Finish(unsigned context) {
    if (sizes_[context] > 0) Pack(context);
    return bytes_[context];
  }

 private:
  static constexpr std::size_t kBuffered = 1000;  // whole bytes of each radix
  static constexpr std::size_t kPiece = 512;

  void AddPiece(std::span<const std::uint8_t> followed) {
    for (const std::uint8_t pixel : followed) {
      const unsigned context = pixel % kContextNumbers;
      rules_[context][sizes_[context]++] = static_cast<Rule>(pixel >> kContextBits);
    }
    for (const unsigned context : kContexts)
      if (sizes_[context] >= kBuffered) Pack(context);
  }

  // As many as are packed at a time, or all that there are.
  void Pack(unsigned context) {
    const ContextDigits& digits = kContextDigits[context];
    auto& rules = rules_[context];
    const std::uint32_t size = std::min<std::uint32_t>(sizes_[context], kBuffered);
    for (std::uint32_t first = 0; first < size; first += digits.per_byte) {
      std::uint32_t byte = 0;
      for (std::uint32_t i = first; i < first + digits.per_byte; ++i)
        byte = byte * digits.radix + (i < size ? digits.digit_of[rules[i]] : 0U);
      bytes_[context].push_back(static_cast<char>(byte));
    }
    std::copy(rules.begin() + size, rules.begin() + sizes_[context], rules.begin());
    sizes_[context] -= size;
  }

  std::array<std::array<Rule, kBuffered + kPiece>, kContextNumbers> rules_;
  std::array<std::uint32_t, kContextNumbers> sizes_{};
  std::array<std::string, kContextNumbers> bytes_;
};

// A row of labels with a 0, as labels outside the map count, at either end.
using FramedRow = std::vector<SegmentIndex>;

// What LabelsAround says, written out: of its members and truth values GCC 12 makes no vectors. LabelCodec's tests read
// back what this writes by LabelsAround.
void FindRules(const FramedRow& above_row, const FramedRow& row, std::vector<std::uint8_t>& followed) {
  constexpr std::uint32_t kRules[kNumRules] = {kLikelier, kOther, kAboveRight, kExplicit};
  const SegmentIndex* const here = row.data();
  const SegmentIndex* const over = above_row.data();
  std::uint8_t* const to = followed.data();
  const std::size_t width = followed.size();
  for (std::size_t x = 0; x < width; ++x) {
    const SegmentIndex label = here[x + 1];
    const SegmentIndex left = here[x];
    const SegmentIndex above_left = over[x];
    const SegmentIndex above = over[x + 1];
    const SegmentIndex above_right = over[x + 2];
    const SegmentIndex likelier = left == above_left ? above : left;
    const SegmentIndex other = left == above_left ? left : above;
    std::uint32_t rule = label == above_right ? kRules[kAboveRight] : kRules[kExplicit];
    rule = label == other ? kRules[kOther] : rule;
    rule = label == likelier ? kRules[kLikelier] : rule;
    const std::uint32_t context = (left == above ? 1U : 0U) | (left == above_left ? 2U : 0U) |
                                  (above == above_left ? 4U : 0U) | (above_right == above ? 8U : 0U) |
                                  (above_right == left ? 16U : 0U);
    to[x] = static_cast<std::uint8_t>(context | rule << kContextBits);
  }
}

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
  const auto width = static_cast<std::size_t>(labels.width());
  FramedRow above(width + 2, 0);
  FramedRow here(width + 2, 0);
  std::vector<std::uint8_t> followed(width);
  std::vector<std::size_t> explicit_at(width);
  for (int y = 0; y < labels.height(); ++y, above.swap(here)) {
    std::copy_n(labels.row(y), width, here.begin() + 1);
    FindRules(above, here, followed);
    rules.Add(followed);
    std::size_t num_explicit = 0;  // without a branch, which could not be foreseen
    for (std::size_t x = 0; x < width; ++x) {
      explicit_at[num_explicit] = x;
      num_explicit += followed[x] >= kFirstExplicit ? 1 : 0;
    }
    for (const std::size_t x : std::span(explicit_at).first(num_explicit))
      explicit_labels.Add(here[x + 1], y > 0 ? above[x + 1] : here[x]);
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
