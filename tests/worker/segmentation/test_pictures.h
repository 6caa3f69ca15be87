#ifndef DEPTHFARM_TESTS_WORKER_SEGMENTATION_TEST_PICTURES_H_
#define DEPTHFARM_TESTS_WORKER_SEGMENTATION_TEST_PICTURES_H_

#include <cstdint>
#include <ostream>
#include <vector>

#include "common/image/picture.h"

namespace depthfarm {

// Independent uniform values: the least smooth picture there is.
YcbcrImage NoisePicture(int width, int height, std::uint32_t seed);
// Smooth slopes in all three channels, a few levels of noise, some straight edges: like a photograph.
YcbcrImage ScenePicture(int width, int height, std::uint32_t seed);
// Luma rises along x, chroma along y.
YcbcrImage GradientPicture(int width, int height);
// One colour: every distance is a matter of position, ties everywhere.
YcbcrImage ConstantPicture(int width, int height);

struct NamedPicture {
  const char* name;
  YcbcrImage picture;
  int num_segments;
};
std::ostream& operator<<(std::ostream& out, const NamedPicture& picture);

// The pictures of the property tests: all kinds, odd shapes, from one segment to one a pixel.
std::vector<NamedPicture> PropertyPictures();

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_WORKER_SEGMENTATION_TEST_PICTURES_H_
