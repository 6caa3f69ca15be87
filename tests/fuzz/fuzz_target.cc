#include "tests/fuzz/fuzz_target.h"

#include <cstdio>
#include <cstdlib>

namespace depthfarm::fuzz {

std::uint64_t accepted = 0;

void Require(bool holds, const char* claim) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", claim);
  std::abort();
}

}  // namespace depthfarm::fuzz
