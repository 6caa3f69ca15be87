#include "worker/segmentation/explicit_labels.h"

#include <algorithm>

#include "common/base/little_endian.h"

namespace depthfarm {
namespace {

// Differences that are counted: a few rows of segments up or down. Others are too many and too rare for the table.
constexpr std::uint32_t kFarthest = 1U << 15U;
constexpr std::uint32_t kCounted = 2 * kFarthest;

// Where a difference is counted; kCounted or more: nowhere.
std::uint32_t Slot(std::uint32_t difference) { return difference + kFarthest; }

std::vector<std::uint32_t> Commonest(const std::vector<std::uint32_t>& counts) {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t slot = 0; slot < kCounted; ++slot)
    if (counts[slot] > 0) slots.push_back(slot);
  const std::size_t size = std::min(slots.size(), kMaxTable);
  std::partial_sort(
      slots.begin(), slots.begin() + static_cast<std::ptrdiff_t>(size), slots.end(),
      [&counts](std::uint32_t a, std::uint32_t b) { return counts[a] != counts[b] ? counts[a] > counts[b] : a < b; });
  slots.resize(size);
  return slots;
}

}  // namespace

ExplicitLabels::Coded ExplicitLabels::Code() const {
  std::vector<std::uint32_t> counts(kCounted, 0);
  SegmentIndex largest = 0;
  for (const auto& [label, near] : labels_) {
    if (label == largest + 1) {
      largest = label;
      continue;
    }
    largest = std::max(largest, label);
    if (const std::uint32_t slot = Slot(label - near); slot < kCounted) ++counts[slot];
  }
  Coded coded;
  std::vector<std::uint8_t> code_of(kCounted, kPlainCode);
  for (const std::uint32_t slot : Commonest(counts)) {
    coded.table.push_back(slot - kFarthest);
    code_of[slot] = static_cast<std::uint8_t>(coded.table.size());
  }
  coded.codes.reserve(labels_.size());
  largest = 0;
  for (const auto& [label, near] : labels_) {
    const std::uint32_t slot = Slot(label - near);
    const std::uint8_t code = label == largest + 1 ? kNextCode : slot < kCounted ? code_of[slot] : kPlainCode;
    if (code == kPlainCode) coded.plain.push_back(label);
    coded.codes.push_back(static_cast<char>(code));
    largest = std::max(largest, label);
  }
  return coded;
}

ExplicitLabelReader::ExplicitLabelReader(std::string_view table, std::string_view codes, std::string_view plain)
    : codes_(codes), plain_(plain) {
  for (std::size_t at = 0; at + 4 <= table.size(); at += 4) table_.push_back(ReadU32(table, at));
}

std::optional<SegmentIndex> ExplicitLabelReader::Next(SegmentIndex near) {
  if (codes_.empty()) return std::nullopt;
  const auto code = static_cast<std::uint8_t>(codes_.front());
  codes_.remove_prefix(1);
  SegmentIndex label = largest_ + 1;
  if (code == kPlainCode) {
    if (plain_.size() < 4) return std::nullopt;
    label = ReadU32(plain_, 0);
    plain_.remove_prefix(4);
  } else if (code != kNextCode) {
    if (code > table_.size()) return std::nullopt;
    label = near + table_[code - 1U];
  }
  largest_ = std::max(largest_, label);
  return label;
}

}  // namespace depthfarm
