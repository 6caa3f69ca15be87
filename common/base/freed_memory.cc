#include "common/base/freed_memory.h"

#include <malloc.h>

namespace depthfarm {

void KeepFreedMemory(const FreedMemory& kept) {
  mallopt(M_TRIM_THRESHOLD, static_cast<int>(kept.most_bytes));           // NOLINT(concurrency-mt-unsafe)
  mallopt(M_MMAP_THRESHOLD, static_cast<int>(kept.largest_block_bytes));  // NOLINT(concurrency-mt-unsafe)
}

void ReturnFreedMemory() { malloc_trim(0); }

}  // namespace depthfarm
