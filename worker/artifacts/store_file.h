#ifndef DEPTHFARM_WORKER_ARTIFACTS_STORE_FILE_H_
#define DEPTHFARM_WORKER_ARTIFACTS_STORE_FILE_H_

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/job/task_spec.h"

namespace depthfarm {

// One artifact as a file: "DFART002", its digest (artifact_digest.h, 32 bytes), its size (8 bytes, little-endian), the
// artifact.
inline constexpr std::uint64_t kStoreFileHeaderBytes = 48;

// Which file it is: another one of the same name differs. (It is not what was modified last: files are touched.)
struct FileId {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::uint64_t bytes = 0;
  bool operator==(const FileId&) const = default;
};

struct StoreFileHeader {
  ContentDigest content_digest{};
  std::uint64_t bytes = 0;
  FileId file;
};

// Header and artifact, as a new file. The folder must exist.
// Errors: kUnavailable, naming the file and the system's reason.
[[nodiscard]] Status WriteStoreFile(const std::string& path, const ContentDigest& content_digest,
                                    std::string_view artifact);

// Errors: kUnavailable when the file cannot be read; kCorrupt when it is not such a file or its size does not fit its
// header. The artifact itself is not looked at.
[[nodiscard]] Result<StoreFileHeader> ReadStoreFileHeader(const std::string& path);

// Of the file that is there now; nothing if there is none.
[[nodiscard]] std::optional<FileId> IdOfFile(const std::string& path);

// Fills `bytes` with those of the artifact from `offset` on. Errors: kUnavailable (also when the file ends before, or
// is another one than `file`).
[[nodiscard]] Status ReadStoreFileBytes(const std::string& path, const FileId& file, std::uint64_t offset,
                                        std::span<char> bytes);
// Of the artifact as it is in the file, read in steps of a MiB. Errors as ReadStoreFileBytes.
[[nodiscard]] Result<ContentDigest> DigestOfStoreFile(const std::string& path, const FileId& file);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_STORE_FILE_H_
