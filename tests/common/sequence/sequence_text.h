#ifndef DEPTHFARM_TESTS_COMMON_SEQUENCE_SEQUENCE_TEXT_H_
#define DEPTHFARM_TESTS_COMMON_SEQUENCE_SEQUENCE_TEXT_H_

#include <stdexcept>
#include <string>

namespace depthfarm {

// A small valid sequence of two cameras with two frames each; tests change one part of its text.
inline constexpr const char* kSequenceText = R"({
  "name": "small", "zNear": 2.0, "zFar": 10, "frameRate": 15, "reference": "b", "notes": "free",
  "x-own": {"any": [1, "thing"]},
  "cameras": [
    {"name": "a", "width": 64, "height": 48, "K": [[50, 0, 31.5], [0, 50, 23.5], [0, 0, 1]],
     "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [0, 0, 0], "images": ["a/0.png", "a/1.png"], "x-row": 3},
    {"name": "b", "width": 64, "height": 48, "K": [[50, 0, 31.5], [0, 50, 23.5], [0, 0, 1]],
     "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [-1, 0, 0], "images": ["b/0.yuv", "b/./x/../1.yuv"],
     "format": "yuv420p10le", "range": "full", "matrix": "bt709", "zNear": 3, "masks": ["m0", "m1"]}
  ]
})";

inline constexpr const char* kImagesOfA = R"("images": ["a/0.png", "a/1.png"])";

// `text` with its first `from` replaced; throws where there is none, so that no test passes by a typo.
inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t position = text.find(from);
  if (position == std::string::npos) throw std::invalid_argument("no '" + from + "' in the text");
  return text.replace(position, from.size(), to);
}

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COMMON_SEQUENCE_SEQUENCE_TEXT_H_
