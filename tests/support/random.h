#ifndef DEPTHFARM_TESTS_SUPPORT_RANDOM_H_
#define DEPTHFARM_TESTS_SUPPORT_RANDOM_H_

#include <cstdint>

namespace depthfarm::test {

// splitmix64: the same numbers on every platform for one printed seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t Next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  // Uniform in [low, high].
  int Int(int low, int high) { return low + static_cast<int>(Next() % static_cast<std::uint64_t>(high - low + 1)); }
  bool Chance(int percent) { return Int(1, 100) <= percent; }

 private:
  std::uint64_t state_;
};

}  // namespace depthfarm::test

#endif  // DEPTHFARM_TESTS_SUPPORT_RANDOM_H_
