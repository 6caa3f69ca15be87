#include "common/base/freed_memory.h"

#include <malloc.h>

namespace depthfarm {

void KeepFreedMemory(const FreedMemory& kept) {
  // NOLINTBEGIN(concurrency-mt-unsafe): there is no other thread yet
  mallopt(M_TRIM_THRESHOLD, static_cast<int>(kept.most_bytes));
  mallopt(M_MMAP_THRESHOLD, static_cast<int>(kept.largest_block_bytes));
  // NOLINTEND(concurrency-mt-unsafe)
}

void ReturnFreedMemory() { malloc_trim(0); }

}  // namespace depthfarm
