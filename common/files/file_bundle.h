#ifndef DEPTHFARM_COMMON_FILES_FILE_BUNDLE_H_
#define DEPTHFARM_COMMON_FILES_FILE_BUNDLE_H_

#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// A file of a bundle. Of a decoded one both parts lie in the bundle's bytes.
struct BundledFile {
  std::string_view path;
  std::string_view bytes;
};

// Several files as one byte string: "DFFB", version 1 (32 bits), the number of files (32), of each the length of its
// path (32) and of its bytes (64) and the path; then the bytes of all, in the same order. Numbers are little-endian;
// nothing is compressed. Same files, same bytes.
//
// Bounds: 2,048 files, paths of 1 to 1,000 bytes.
[[nodiscard]] std::string EncodeFileBundle(const std::vector<BundledFile>& files);

// The files of a bundle from anywhere. kCorrupt: it is none, ends early or goes on, is out of bounds, or a path is
// there twice or is not made of plain names ("a/b.png"; no "..", no "/" at its ends, no control characters): none of
// them leads out of the folder that it is put into.
[[nodiscard]] Result<std::vector<BundledFile>> DecodeFileBundle(std::string_view bundle);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_FILES_FILE_BUNDLE_H_
