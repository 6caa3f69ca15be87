#ifndef DEPTHFARM_COMMON_FILES_ATOMIC_FILE_H_
#define DEPTHFARM_COMMON_FILES_ATOMIC_FILE_H_

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// The whole content of a regular file of at most `max_bytes` bytes.
// Errors  kUnavailable: the file is missing or cannot be read; kInvalidArgument: it is not a regular file (a pipe would
//         block, a folder has no bytes), or holds more than `max_bytes`: both numbers are said. All name the path.
[[nodiscard]] Result<std::string> ReadFileBytes(const std::string& path, std::uint64_t max_bytes);

// `count` bytes of a regular file from `offset` on. Errors: as ReadFileBytes; kInvalidArgument where the file ends
// before: its size and the place are said.
[[nodiscard]] Result<std::string> ReadFileRange(const std::string& path, std::uint64_t offset, std::uint64_t count);

enum class Durability {
  kCached,  // survives the death of the process
  kSynced,  // survives the loss of power too: file and folder are synced before the call returns
};

// Writes `bytes` under a temporary name in the folder of `path` and renames it to `path`: a reader sees the old file,
// the new one or none, never a part, and two writers of one path leave one of their files whole. The folder must exist.
// Errors  kUnavailable, naming the path and the system's reason; the temporary file is removed.
[[nodiscard]] Status WriteFileAtomically(const std::string& path, std::string_view bytes,
                                         Durability durability = Durability::kCached);
// The same; the file is renamed only if `last_look`, right before, returns ok.
[[nodiscard]] Status WriteFileAtomically(const std::string& path, std::string_view bytes,
                                         const std::function<Status()>& last_look);
// The same of several pieces, one after the other.
[[nodiscard]] Status WriteFileAtomically(const std::string& path, std::span<const std::string_view> pieces,
                                         Durability durability = Durability::kCached);

// Makes `path` and all folders above it; ok when it is there already.
// Errors  kUnavailable, naming the path: no permission, or a part of it is a file.
[[nodiscard]] Status MakeDirectories(const std::string& path);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_FILES_ATOMIC_FILE_H_
