#include "worker/segmentation/label_codec.h"

#include <cstdint>
#include <optional>
#include <utility>

namespace depthfarm {
namespace {

enum Rule : char { kLikelier = 0, kOther = 1, kAboveRight = 2, kExplicit = 3 };

struct Prediction {
  SegmentIndex likelier = 0;
  SegmentIndex other = 0;
  SegmentIndex above_right = 0;
  SegmentIndex near_explicit = 0;  // what explicit labels are counted from
};

// From the pixels before (x, y) alone, so that reader and writer agree. Outside the picture labels are 0. `row` is that
// of y, `above_row` the one before it, null at the top.
Prediction Predict(const SegmentIndex* row, const SegmentIndex* above_row, int x, int width) {
  const SegmentIndex left = x > 0 ? row[x - 1] : 0;
  const SegmentIndex above = above_row != nullptr ? above_row[x] : 0;
  const SegmentIndex above_left = above_row != nullptr && x > 0 ? above_row[x - 1] : 0;
  Prediction prediction{.likelier = left,
                        .other = above,
                        .above_right = above_row != nullptr && x + 1 < width ? above_row[x + 1] : 0,
                        .near_explicit = above_row != nullptr ? above : left};
  // A border that ran between above left and above goes on downwards; one that ran between above left and left goes
  // right.
  if (left == above_left) std::swap(prediction.likelier, prediction.other);
  return prediction;
}

std::uint64_t FoldSign(std::int64_t value) {
  return value >= 0 ? static_cast<std::uint64_t>(value) * 2 : static_cast<std::uint64_t>(-(value + 1)) * 2 + 1;
}

std::int64_t UnfoldSign(std::uint64_t folded) {
  const auto half = static_cast<std::int64_t>(folded / 2);
  return folded % 2 == 0 ? half : -half - 1;
}

void AppendVarint(std::uint64_t value, std::string& bytes) {
  for (; value >= 0x80; value >>= 7U) bytes.push_back(static_cast<char>(value | 0x80U));
  bytes.push_back(static_cast<char>(value));
}

// Takes one varint off the front of `bytes`; none where it does not end within kMaxExplicitLabelBytes.
std::optional<std::uint64_t> TakeVarint(std::string_view& bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < kMaxExplicitLabelBytes && i < bytes.size(); ++i) {
    const auto byte = static_cast<std::uint8_t>(bytes[i]);
    value |= std::uint64_t{byte & 0x7FU} << (7 * i);
    if (byte < 0x80U) {
      bytes.remove_prefix(i + 1);
      return value;
    }
  }
  return std::nullopt;
}

}  // namespace

void AppendLabels(const Grid<SegmentIndex>& labels, std::string& bytes) {
  std::string explicit_labels;
  const std::size_t start = bytes.size();
  bytes.resize(start + labels.size());
  char* rules = bytes.data() + start;
  for (int y = 0; y < labels.height(); ++y) {
    const SegmentIndex* row = labels.row(y);
    const SegmentIndex* above_row = y > 0 ? labels.row(y - 1) : nullptr;
    for (int x = 0; x < labels.width(); ++x) {
      const SegmentIndex label = row[x];
      const Prediction prediction = Predict(row, above_row, x, labels.width());
      Rule rule = kExplicit;
      if (label == prediction.likelier) {
        rule = kLikelier;
      } else if (label == prediction.other) {
        rule = kOther;
      } else if (label == prediction.above_right) {
        rule = kAboveRight;
      } else {
        AppendVarint(FoldSign(std::int64_t{label} - std::int64_t{prediction.near_explicit}), explicit_labels);
      }
      *rules++ = rule;
    }
  }
  bytes += explicit_labels;
}

Result<Grid<SegmentIndex>> ReadLabels(std::string_view bytes, int width, int height, SegmentIndex num_segments) {
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (bytes.size() < pixels) {
    return Corrupt("label map ends after " + std::to_string(bytes.size()) + " bytes, expected at least " +
                   std::to_string(pixels));
  }
  std::string_view explicit_labels = bytes.substr(pixels);
  Grid<SegmentIndex> labels(width, height);
  for (int y = 0; y < height; ++y) {
    SegmentIndex* row = labels.row(y);
    const SegmentIndex* above_row = y > 0 ? labels.row(y - 1) : nullptr;
    for (int x = 0; x < width; ++x) {
      const Prediction prediction = Predict(row, above_row, x, width);
      std::int64_t label = -1;
      switch (bytes[labels.Index(x, y)]) {
        case kLikelier:
          label = prediction.likelier;
          break;
        case kOther:
          label = prediction.other;
          break;
        case kAboveRight:
          label = prediction.above_right;
          break;
        case kExplicit:
          if (const auto folded = TakeVarint(explicit_labels)) label = prediction.near_explicit + UnfoldSign(*folded);
          break;
        default:
          break;
      }
      if (label < 0 || label >= std::int64_t{num_segments}) {
        return Corrupt("label at (" + std::to_string(x) + ", " + std::to_string(y) +
                       ") is unreadable or outside 0 to " + std::to_string(std::int64_t{num_segments} - 1));
      }
      row[x] = static_cast<SegmentIndex>(label);
    }
  }
  if (!explicit_labels.empty()) {
    return Corrupt("label map has " + std::to_string(explicit_labels.size()) + " bytes left over after its last label");
  }
  return labels;
}

}  // namespace depthfarm
