#include "worker/transfer/served_files.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string_view>

#include "common/digest/sha256.h"
#include "common/files/open_file.h"
#include "worker/artifacts/artifact_digest.h"

namespace depthfarm {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 32;
constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

bool SameTime(const timespec& a, const timespec& b) { return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec; }

}  // namespace

Result<UploadedFile> ServedFiles::Add(const std::string& path, const std::function<bool()>& stop) {
  if (const auto known = added_.find(path); known != added_.end()) return known->second;
  const OpenFile file = OpenToRead(path);
  if (!file.ok()) return FileFailure(path, "open the file");
  struct stat facts {};
  if (fstat(file.descriptor(), &facts) != 0) return FileFailure(path, "examine the file");
  if (!S_ISREG(facts.st_mode)) return InvalidArgument(path + ": is not a regular file");
  UploadedFile upload;
  FileDigest& digest = upload.file;
  digest.bytes = static_cast<std::uint64_t>(facts.st_size);
  if (digest.bytes == 0 || digest.bytes > kMaxFileBytes) {
    return InvalidArgument(path + ": holds " + std::to_string(digest.bytes) + " bytes, expected 1 to " +
                           std::to_string(kMaxFileBytes));
  }
  Sha256Hasher hasher;
  ArtifactHasher artifact_hasher;
  std::string piece(kPieceBytes, '\0');
  for (std::uint64_t at = 0; at < digest.bytes; at += kPieceBytes) {
    if (stop()) return Cancelled();
    DEPTHFARM_ASSIGN_OR_RETURN(const std::size_t count, ReadUpTo(path, file, at, piece));
    if (count != std::min<std::uint64_t>(kPieceBytes, digest.bytes - at))
      return Unavailable(path + ": changed while it was read");
    const std::string_view read = std::string_view(piece).substr(0, count);
    hasher.Update(read);
    artifact_hasher.Update(read);
  }
  digest.sha256 = hasher.Finish();
  upload.artifact_digest = artifact_hasher.Finish();
  files_[digest.sha256] = {path, digest.bytes, facts.st_mtim};
  added_[path] = upload;
  return upload;
}

Result<ArtifactChunk> ServedFiles::ReadChunk(const ArtifactKey& key, std::uint64_t offset, std::uint64_t max_bytes) {
  const auto found = files_.find(key);
  if (found == files_.end()) return Unavailable("file " + Hex(key) + ": is not served here");
  const File& served = found->second;
  if (offset > served.bytes)
    return InvalidArgument(served.path + ": offset " + std::to_string(offset) + " is past its end");
  const OpenFile file = OpenToRead(served.path);
  if (!file.ok()) return FileFailure(served.path, "open the file");
  struct stat facts {};
  if (fstat(file.descriptor(), &facts) != 0) return FileFailure(served.path, "examine the file");
  const std::uint64_t count = std::min(max_bytes, served.bytes - offset);
  DEPTHFARM_ASSIGN_OR_RETURN(std::string bytes, chunk_memory_.Take(static_cast<std::size_t>(count)));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::size_t read, ReadUpTo(served.path, file, offset, bytes));
  if (!S_ISREG(facts.st_mode) || static_cast<std::uint64_t>(facts.st_size) != served.bytes ||
      !SameTime(facts.st_mtim, served.changed) || read != count) {
    return Corrupt(served.path + ": was changed since the job was submitted");
  }
  return ArtifactChunk{served.bytes, chunk_memory_.Share(std::move(bytes))};
}

}  // namespace depthfarm
