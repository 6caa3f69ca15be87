#include "worker/artifacts/store_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <new>

#include "common/base/little_endian.h"
#include "common/files/atomic_file.h"
#include "common/files/open_file.h"

namespace depthfarm {
namespace {

constexpr std::string_view kMagic = "DFART001";

FileId IdOf(const struct stat& facts) {
  return {static_cast<std::uint64_t>(facts.st_dev), static_cast<std::uint64_t>(facts.st_ino),
          static_cast<std::uint64_t>(facts.st_size)};
}

OpenFile OpenToRead(const std::string& path) { return OpenFile(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)); }

// kUnavailable when the file ends before `count` bytes from `position` on.
Result<std::string> ReadAt(const std::string& path, const OpenFile& file, std::uint64_t position, std::uint64_t count) {
  try {
    std::string bytes(static_cast<std::size_t>(count), '\0');
    std::size_t have = 0;
    while (have < bytes.size()) {
      const ssize_t got =
          pread(file.descriptor(), bytes.data() + have, bytes.size() - have, static_cast<off_t>(position + have));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return FileFailure(path, "read the file");
      if (got == 0) return Unavailable(path + ": ends before byte " + std::to_string(position + count));
      have += static_cast<std::size_t>(got);
    }
    return bytes;
  } catch (const std::bad_alloc&) {
    return Unavailable(path + ": no memory for " + std::to_string(count) + " bytes of it");
  }
}

}  // namespace

Status WriteStoreFile(const std::string& path, const Sha256Digest& content_digest, std::string_view artifact) {
  std::string header(kMagic);
  header.append(reinterpret_cast<const char*>(content_digest.data()), content_digest.size());
  AppendU64(artifact.size(), header);
  // Two writes, not a copy of the artifact.
  const std::array<std::string_view, 2> pieces{header, artifact};
  return WriteFileAtomically(path, pieces);
}

Result<StoreFileHeader> ReadStoreFileHeader(const std::string& path) {
  const OpenFile file = OpenToRead(path);
  if (!file.ok()) return FileFailure(path, "open the file");
  struct stat facts {};
  if (fstat(file.descriptor(), &facts) != 0) return FileFailure(path, "examine the file");
  if (!S_ISREG(facts.st_mode)) return Corrupt(path + ": is not a regular file");
  const auto size = static_cast<std::uint64_t>(facts.st_size);
  if (size < kStoreFileHeaderBytes) {
    return Corrupt(path + ": holds " + std::to_string(size) + " bytes, expected a header of " +
                   std::to_string(kStoreFileHeaderBytes));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string header, ReadAt(path, file, 0, kStoreFileHeaderBytes));
  if (!header.starts_with(kMagic)) return Corrupt(path + ": is not an artifact file");
  StoreFileHeader result;
  result.file = IdOf(facts);
  std::copy_n(header.begin() + kMagic.size(), result.content_digest.size(), result.content_digest.begin());
  result.bytes = ReadU64(header, kMagic.size() + result.content_digest.size());
  if (result.bytes != size - kStoreFileHeaderBytes) {
    return Corrupt(path + ": header says " + std::to_string(result.bytes) + " bytes, file holds " +
                   std::to_string(size - kStoreFileHeaderBytes));
  }
  return result;
}

std::optional<FileId> IdOfFile(const std::string& path) {
  struct stat facts {};
  if (lstat(path.c_str(), &facts) != 0 || !S_ISREG(facts.st_mode)) return std::nullopt;
  return IdOf(facts);
}

Result<std::string> ReadStoreFileBytes(const std::string& path, const FileId& expected, std::uint64_t offset,
                                       std::uint64_t count) {
  const OpenFile file = OpenToRead(path);
  if (!file.ok()) return FileFailure(path, "open the file");
  struct stat facts {};
  if (fstat(file.descriptor(), &facts) != 0) return FileFailure(path, "examine the file");
  if (IdOf(facts) != expected) return Unavailable(path + ": was replaced");
  return ReadAt(path, file, kStoreFileHeaderBytes + offset, count);
}

}  // namespace depthfarm
