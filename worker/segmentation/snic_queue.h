#ifndef DEPTHFARM_WORKER_SEGMENTATION_SNIC_QUEUE_H_
#define DEPTHFARM_WORKER_SEGMENTATION_SNIC_QUEUE_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace depthfarm {

// A pixel that waits to join a segment.
struct SnicElement {
  double distance = 0;  // >= 0
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  std::uint32_t sequence = 0;  // the queue's own: orders equal distances

  // Not short-circuited: which of two elements goes first is a coin toss that no branch predictor wins.
  [[nodiscard]] bool Before(const SnicElement& other) const {
    return (distance < other.distance) | ((distance == other.distance) & (sequence < other.sequence));
  }
};

// Priority queue, smallest distance first, equal ones in the order they were pushed. At most 2^32 pushes.
//
// Elements lie unordered in buckets of like distances. Those of the nearest bucket are sorted when its turn comes: the
// run. What is pushed before the run's end is a heap beside it, which is so small that it stays in the cache.
class SnicQueue {
 public:
  SnicQueue() : buckets_(kBuckets) {}

  void Push(double distance, int x, int y) {
    const SnicElement element{distance, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), next_sequence_};
    const std::size_t bucket = BucketOf(distance);
    if (bucket <= nearest_) {
      ++next_sequence_;
      heap_.push_back(element);
      SiftUp(heap_.size() - 1, element);
      return;
    }
    buckets_[bucket].emplace_back(element);
    filled_[bucket / kWordBits] |= std::uint64_t{1} << bucket % kWordBits;
  }

  // Removes the first element; false if there is none. May drop elements that `is_live(element)` does not hold for
  // before their turn, but serves some of them: an element that is not live must never become so again.
  template <typename IsLive>
  bool Pop(const IsLive& is_live, SnicElement& first) {
    if (next_ == run_.size() && heap_.empty() && !OpenNextBucket(is_live)) return false;
    const bool from_run = next_ < run_.size() && (heap_.empty() || run_[next_].Before(heap_.front()));
    first = from_run ? run_[next_++] : PopHeap();
    return true;
  }

  // The element that is served after `others` others, if nothing nearer is pushed meanwhile; null if not known.
  [[nodiscard]] const SnicElement* Upcoming(std::size_t others) const {
    return next_ + others < run_.size() ? &run_[next_ + others] : nullptr;
  }

 private:
  static constexpr std::size_t kChildren = 4;
  static constexpr std::size_t kWordBits = 64;
  // 64 buckets an octave of distances from 2^-10 to 2^22; what is nearer or farther goes into the first or last one.
  static constexpr unsigned kShift = 52 - 6;
  static constexpr std::uint64_t kFirst = std::bit_cast<std::uint64_t>(0x1p-10) >> kShift;
  static constexpr std::size_t kBuckets = 64 * 32;
  // A bucket is sorted by counting into this many parts first: with ten thousand elements there are a few in each.
  static constexpr unsigned kPartBits = 11;
  static constexpr std::size_t kParts = std::size_t{1} << kPartBits;

  // An element of a bucket that is not open: 12 bytes, there are two for each pixel of the picture. A bucket is in the
  // order of pushing, so its elements are numbered when it is opened.
  struct Unordered {
    std::uint32_t distance_low;
    std::uint32_t distance_high;
    std::uint16_t x;
    std::uint16_t y;

    explicit Unordered(const SnicElement& element)
        : distance_low(static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(element.distance))),
          distance_high(static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(element.distance) >> 32U)),
          x(element.x),
          y(element.y) {}
    [[nodiscard]] SnicElement Numbered(std::uint32_t sequence) const {
      return {std::bit_cast<double>(std::uint64_t{distance_high} << 32U | distance_low), x, y, sequence};
    }
  };

  // Both grow with the distance.
  static std::size_t BucketOf(double distance) {
    const std::uint64_t position = std::bit_cast<std::uint64_t>(distance) >> kShift;
    return std::min<std::uint64_t>(std::max(position, kFirst) - kFirst, kBuckets - 1);
  }
  [[nodiscard]] std::size_t PartOf(double distance) const {
    // The first and last bucket are of any distances: sorting parts would not sort them.
    if (nearest_ == 0 || nearest_ == kBuckets - 1) return 0;
    return (std::bit_cast<std::uint64_t>(distance) >> (kShift - kPartBits)) % kParts;
  }

  // Requires an empty heap and a run that is served. False if no bucket with live elements is left.
  template <typename IsLive>
  bool OpenNextBucket(const IsLive& is_live) {
    do {
      std::size_t word = 0;
      while (word < filled_.size() && filled_[word] == 0) ++word;
      if (word == filled_.size()) return false;
      nearest_ = word * kWordBits + static_cast<std::size_t>(std::countr_zero(filled_[word]));
      filled_[word] &= filled_[word] - 1;
      std::vector<Unordered> bucket;  // frees the memory at the end: few buckets are filled again
      bucket.swap(buckets_[nearest_]);
      opened_.resize(bucket.size());
      std::size_t live = 0;
      for (const Unordered& waiting : bucket) {  // not branched on liveness: that is a coin toss, too
        opened_[live] = waiting.Numbered(next_sequence_);
        const bool keep = is_live(opened_[live]);
        live += keep ? 1 : 0;
        next_sequence_ += keep ? 1 : 0;
      }
      opened_.resize(live);
      SortIntoRun(opened_);
    } while (run_.empty());
    return true;
  }

  void SortIntoRun(const std::vector<SnicElement>& elements) {
    std::array<std::uint32_t, kParts + 1> begin = {};
    for (const SnicElement& element : elements) ++begin[PartOf(element.distance) + 1];
    for (std::size_t part = 0; part < kParts; ++part) begin[part + 1] += begin[part];
    run_.resize(elements.size());
    next_ = 0;
    for (const SnicElement& element : elements) run_[begin[PartOf(element.distance)]++] = element;
    // Counting has moved each part's beginning to its end.
    auto from = run_.begin();
    for (std::size_t part = 0; part < kParts; ++part) {
      const auto to = run_.begin() + begin[part];
      if (to - from > 1) std::sort(from, to, [](const auto& a, const auto& b) { return a.Before(b); });
      from = to;
    }
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

  std::vector<SnicElement> run_;  // sorted
  std::size_t next_ = 0;          // those of the run before it are served
  std::vector<SnicElement> heap_;
  std::vector<std::vector<Unordered>> buckets_;
  std::vector<SnicElement> opened_;  // the live elements of the bucket that is being opened
  std::array<std::uint64_t, kBuckets / kWordBits> filled_ = {};
  std::size_t nearest_ = 0;  // the bucket that the run was made of: nearer ones are empty
  std::uint32_t next_sequence_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_SNIC_QUEUE_H_
