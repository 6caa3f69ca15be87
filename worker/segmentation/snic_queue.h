#ifndef DEPTHFARM_WORKER_SEGMENTATION_SNIC_QUEUE_H_
#define DEPTHFARM_WORKER_SEGMENTATION_SNIC_QUEUE_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace depthfarm {

// A pixel that waits to join a segment. 16 bytes: the queue is what SNIC spends its time on.
struct SnicElement {
  double distance = 0;         // >= 0
  std::uint32_t sequence = 0;  // order of pushing, so that no two elements are equal
  std::uint16_t x = 0;
  std::uint16_t y = 0;

  // Not short-circuited: which of two elements goes first is a coin toss that no branch predictor wins.
  [[nodiscard]] bool Before(const SnicElement& other) const {
    return (distance < other.distance) | ((distance == other.distance) & (sequence < other.sequence));
  }
};

// Priority queue, smallest (distance, sequence) first. Elements lie unordered in buckets of like distances; only those
// of the nearest bucket, and what is pushed before its end, are a heap, which is so small that it stays in the cache.
class SnicQueue {
 public:
  SnicQueue() : buckets_(kBuckets) {}

  void Push(const SnicElement& element) {
    const std::size_t bucket = BucketOf(element.distance);
    if (bucket <= nearest_) {
      heap_.push_back(element);
      SiftUp(heap_.size() - 1, element);
      return;
    }
    buckets_[bucket].push_back(element);
    filled_[bucket / kWordBits] |= std::uint64_t{1} << bucket % kWordBits;
  }

  // The first element that `is_live` holds for, with those before it removed; false if there is none. An element that
  // is not live must never become so again: it may be dropped before its turn.
  template <typename IsLive>
  bool Pop(const IsLive& is_live, SnicElement& first) {
    while (!heap_.empty() || OpenNextBucket(is_live)) {
      first = PopHeap();
      if (is_live(first)) return true;
    }
    return false;
  }

 private:
  static constexpr std::size_t kChildren = 4;
  static constexpr std::size_t kWordBits = 64;
  // 64 buckets an octave of distances from 2^-10 to 2^22; what is nearer or farther goes into the first or last one.
  static constexpr unsigned kShift = 52 - 6;
  static constexpr std::uint64_t kFirst = std::bit_cast<std::uint64_t>(0x1p-10) >> kShift;
  static constexpr std::size_t kBuckets = 64 * 32;

  static std::size_t BucketOf(double distance) {
    const std::uint64_t position = std::bit_cast<std::uint64_t>(distance) >> kShift;  // grows with the distance
    return std::min<std::uint64_t>(std::max(position, kFirst) - kFirst, kBuckets - 1);
  }

  // Requires an empty heap. False if there is no bucket left; the heap may be empty still, of a bucket without live
  // elements.
  template <typename IsLive>
  bool OpenNextBucket(const IsLive& is_live) {
    do {
      std::size_t word = 0;
      while (word < filled_.size() && filled_[word] == 0) ++word;
      if (word == filled_.size()) return false;
      nearest_ = word * kWordBits + static_cast<std::size_t>(std::countr_zero(filled_[word]));
      filled_[word] &= filled_[word] - 1;
      std::vector<SnicElement>& bucket = buckets_[nearest_];
      for (const SnicElement& element : bucket) {
        if (is_live(element)) heap_.push_back(element);
      }
      bucket.clear();
    } while (heap_.empty());
    for (std::size_t i = 1; i < heap_.size(); ++i) SiftUp(i, SnicElement(heap_[i]));
    return true;
  }

  // Requires a heap that is not empty.
  SnicElement PopHeap() {
    const SnicElement top = heap_.front();
    const SnicElement last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) Refill(last);
    return top;
  }

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
  std::vector<std::vector<SnicElement>> buckets_;
  std::array<std::uint64_t, kBuckets / kWordBits> filled_ = {};
  std::size_t nearest_ = 0;  // the bucket that the heap was made of: nearer ones are empty
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_SNIC_QUEUE_H_
