#ifndef DEPTHFARM_COMMON_BASE_DOUBLE_PAIR_H_
#define DEPTHFARM_COMMON_BASE_DOUBLE_PAIR_H_

namespace depthfarm {

// Two numbers in one register, for instance a position (x, y): GCC's and Clang's vector type. Each is rounded as a
// double by itself, so what is computed is the same as one after the other.
using DoublePair = double __attribute__((vector_size(16)));

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_DOUBLE_PAIR_H_
