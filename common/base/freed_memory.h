#ifndef DEPTHFARM_COMMON_BASE_FREED_MEMORY_H_
#define DEPTHFARM_COMMON_BASE_FREED_MEMORY_H_

#include <cstddef>

namespace depthfarm {

// What this process keeps of the memory that it frees. Pictures and maps are made and dropped by the dozen: giving
// their memory back to the system and asking for it again, page by page, costs time.
struct FreedMemory {
  std::size_t most_bytes = 0;           // at the end of the heap: what is beyond goes back
  std::size_t largest_block_bytes = 0;  // larger blocks are asked for, and go back, one by one
};

// For the rest of the process; before its first thread starts. Both at most 2^31 - 1. An allocator that cannot (a
// sanitizer's) does as it always does.
void KeepFreedMemory(const FreedMemory& kept);

// Gives back what is kept now.
void ReturnFreedMemory();

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_FREED_MEMORY_H_
