#ifndef DEPTHFARM_WORKER_SEGMENTATION_SNIC_QUEUE_H_
#define DEPTHFARM_WORKER_SEGMENTATION_SNIC_QUEUE_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace depthfarm {

// A pixel that waits to join a segment. 16 bytes: the queue is what SNIC spends its time on.
struct SnicElement {
  double distance = 0;
  std::uint32_t sequence = 0;  // order of pushing, so that no two elements are equal
  std::uint16_t x = 0;
  std::uint16_t y = 0;

  // Not short-circuited: which of two elements goes first is a coin toss that no branch predictor wins.
  [[nodiscard]] bool Before(const SnicElement& other) const {
    return (distance < other.distance) | ((distance == other.distance) & (sequence < other.sequence));
  }
};

// Priority queue, smallest (distance, sequence) first. A heap of four children a node: half the levels of a binary one,
// and the four lie side by side in memory.
class SnicQueue {
 public:
  void Reserve(std::size_t capacity) { heap_.reserve(capacity); }
  [[nodiscard]] bool empty() const { return heap_.empty(); }

  void Push(const SnicElement& element) {
    heap_.push_back(element);
    SiftUp(heap_.size() - 1, element);
  }

  // Requires !empty().
  SnicElement Pop() {
    const SnicElement top = heap_.front();
    const SnicElement last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) Refill(last);
    return top;
  }

 private:
  static constexpr std::size_t kChildren = 4;

  void SiftUp(std::size_t hole, const SnicElement& element) {
    while (hole > 0) {
      const std::size_t parent = (hole - 1) / kChildren;
      if (!element.Before(heap_[parent])) break;
      heap_[hole] = heap_[parent];
      hole = parent;
    }
    heap_[hole] = element;
  }

  // Fills the hole at the top: smallest children move up to the bottom, then `last`, which belongs near there, goes in.
  void Refill(const SnicElement& last) {
    const std::size_t size = heap_.size();
    std::size_t hole = 0;
    for (std::size_t child = 1; child < size; child = hole * kChildren + 1) {
      const std::size_t end = std::min(child + kChildren, size);
      std::size_t smallest = child;
      for (std::size_t other = child + 1; other < end; ++other) {
        smallest = heap_[other].Before(heap_[smallest]) ? other : smallest;
      }
      heap_[hole] = heap_[smallest];
      hole = smallest;
    }
    SiftUp(hole, last);
  }

  std::vector<SnicElement> heap_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_SNIC_QUEUE_H_
