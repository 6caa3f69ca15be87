#ifndef DEPTHFARM_WORKER_SEGMENTATION_EXPLICIT_LABELS_H_
#define DEPTHFARM_WORKER_SEGMENTATION_EXPLICIT_LABELS_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// The labels of a map that follow from none before them, as codes of one byte (label_codec.h).
inline constexpr std::uint8_t kNextCode = 0;
inline constexpr std::uint8_t kPlainCode = 255;
inline constexpr std::size_t kMaxTable = 254;

class ExplicitLabels {
 public:
  // `near`: the label that the next one is counted from.
  void Add(SegmentIndex label, SegmentIndex near) { labels_.push_back({label, near}); }
  [[nodiscard]] std::size_t size() const { return labels_.size(); }

  struct Coded {
    std::vector<std::uint32_t> table;  // differences, the commonest first, then the smaller (signed)
    std::string codes;
    std::vector<SegmentIndex> plain;
  };
  [[nodiscard]] Coded Code() const;

 private:
  struct Label {
    SegmentIndex label = 0;
    SegmentIndex near = 0;
  };
  std::vector<Label> labels_;
};

// Gives the labels back in order. Borrows all it is made of; `plain` and `table` are u32 each, little-endian.
class ExplicitLabelReader {
 public:
  ExplicitLabelReader(std::string_view table, std::string_view codes, std::string_view plain);

  // None: there is no further label, or the code stands for none.
  [[nodiscard]] std::optional<SegmentIndex> Next(SegmentIndex near);
  [[nodiscard]] bool done() const { return codes_.empty() && plain_.empty(); }

 private:
  std::vector<std::uint32_t> table_;
  std::string_view codes_;
  std::string_view plain_;
  SegmentIndex largest_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_EXPLICIT_LABELS_H_
