#include "worker/artifacts/store_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <span>

#include "common/base/little_endian.h"
#include "common/files/atomic_file.h"
#include "common/files/open_file.h"
#include "worker/artifacts/artifact_digest.h"

namespace depthfarm {
namespace {

constexpr std::string_view kMagic = "DFART002";

FileId IdOf(const struct stat& facts) {
  return {static_cast<std::uint64_t>(facts.st_dev), static_cast<std::uint64_t>(facts.st_ino),
          static_cast<std::uint64_t>(facts.st_size)};
}

OpenFile OpenStored(const std::string& path) { return OpenFile(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)); }

constexpr std::size_t kDigestStepBytes = std::size_t{1} << 20;

// As many bytes as `bytes` has room for, from `position` on; kUnavailable when the file ends before.
Status ReadAt(const std::string& path, const OpenFile& file, std::uint64_t position, std::span<char> bytes) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::size_t have, ReadUpTo(path, file, position, bytes));
  if (have < bytes.size()) return Unavailable(path + ": ends before byte " + std::to_string(position + bytes.size()));
  return {};
}

Status CheckId(const std::string& path, const OpenFile& file, const FileId& expected) {
  if (!file.ok()) return FileFailure(path, "open the file");
  struct stat facts {};
  if (fstat(file.descriptor(), &facts) != 0) return FileFailure(path, "examine the file");
  if (IdOf(facts) != expected) return Unavailable(path + ": was replaced");
  return {};
}

}  // namespace

Status WriteStoreFile(const std::string& path, const ContentDigest& content_digest, std::string_view artifact) {
  std::string header(kMagic);
  header.append(reinterpret_cast<const char*>(content_digest.data()), content_digest.size());
  AppendU64(artifact.size(), header);
  // Two writes, not a copy of the artifact.
  const std::array<std::string_view, 2> pieces{header, artifact};
  return WriteFileAtomically(path, pieces);
}

Result<StoreFileHeader> ReadStoreFileHeader(const std::string& path) {
  const OpenFile file = OpenStored(path);
  if (!file.ok()) return FileFailure(path, "open the file");
  struct stat facts {};
  if (fstat(file.descriptor(), &facts) != 0) return FileFailure(path, "examine the file");
  if (!S_ISREG(facts.st_mode)) return Corrupt(path + ": is not a regular file");
  const auto size = static_cast<std::uint64_t>(facts.st_size);
  if (size < kStoreFileHeaderBytes) {
    return Corrupt(path + ": holds " + std::to_string(size) + " bytes, expected a header of " +
                   std::to_string(kStoreFileHeaderBytes));
  }
  std::string header(kStoreFileHeaderBytes, '\0');
  DEPTHFARM_RETURN_IF_ERROR(ReadAt(path, file, 0, header));
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

Status ReadStoreFileBytes(const std::string& path, const FileId& expected, std::uint64_t offset,
                          std::span<char> bytes) {
  const OpenFile file = OpenStored(path);
  DEPTHFARM_RETURN_IF_ERROR(CheckId(path, file, expected));
  return ReadAt(path, file, kStoreFileHeaderBytes + offset, bytes);
}

Result<ContentDigest> DigestOfStoreFile(const std::string& path, const FileId& expected) {
  const OpenFile file = OpenStored(path);
  DEPTHFARM_RETURN_IF_ERROR(CheckId(path, file, expected));
  ArtifactHasher hasher;
  std::string step(kDigestStepBytes, '\0');
  for (std::uint64_t at = kStoreFileHeaderBytes; at < expected.bytes; at += step.size()) {
    if (expected.bytes - at < step.size()) step.resize(static_cast<std::size_t>(expected.bytes - at));
    DEPTHFARM_RETURN_IF_ERROR(ReadAt(path, file, at, step));
    hasher.Update(step);
  }
  return hasher.Finish();
}

}  // namespace depthfarm
