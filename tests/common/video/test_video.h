#ifndef DEPTHFARM_TESTS_COMMON_VIDEO_TEST_VIDEO_H_
#define DEPTHFARM_TESTS_COMMON_VIDEO_TEST_VIDEO_H_

#include <string>

namespace depthfarm {

inline constexpr int kVideoWidth = 64;
inline constexpr int kVideoHeight = 48;

// A picture of 8 bits, planar 4:2:0: waves that move by `offset` pixels, with noise of +-`noise` that differs in every
// `frame`.
[[nodiscard]] std::string TestPicture(int frame, double offset, int noise);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COMMON_VIDEO_TEST_VIDEO_H_
