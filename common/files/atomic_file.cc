#include "common/files/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "common/files/open_file.h"
#include "common/files/pending_file.h"

namespace depthfarm {
namespace {

constexpr int kNewFileMode = 0666;  // reduced by the umask of the process

Status WritePiece(const std::string& path, const OpenFile& file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file.descriptor(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return FileFailure(path, "write " + std::to_string(bytes.size()) + " bytes");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

Status WriteAll(const std::string& path, std::span<const std::string_view> pieces, Durability durability) {
  OpenFile file(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kNewFileMode));
  if (!file.ok()) return FileFailure(path, "create the file");
  for (const std::string_view piece : pieces) DEPTHFARM_RETURN_IF_ERROR(WritePiece(path, file, piece));
  if (durability == Durability::kSynced && fsync(file.descriptor()) != 0) return FileFailure(path, "sync the file");
  if (!file.Close()) return FileFailure(path, "close the file");
  return {};
}

Status SyncFolderOf(const std::string& path) {
  const std::string parent = std::filesystem::path(path).parent_path().string();
  const std::string folder = parent.empty() ? "." : parent;
  const OpenFile opened(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!opened.ok()) return FileFailure(folder, "open the folder");
  if (fsync(opened.descriptor()) != 0) return FileFailure(folder, "sync the folder");
  return {};
}

Result<std::string> ReadExactly(const std::string& path, const OpenFile& file, std::uint64_t offset,
                                std::uint64_t count) {
  try {
    std::string bytes(static_cast<std::size_t>(count), '\0');
    DEPTHFARM_ASSIGN_OR_RETURN(const std::size_t read, ReadUpTo(path, file, offset, bytes));
    if (read < bytes.size()) return Unavailable(path + ": shrank while it was read");
    return bytes;
  } catch (const std::bad_alloc&) {
    return Unavailable(path + ": no memory for its " + std::to_string(count) + " bytes");
  }
}

}  // namespace

Result<std::string> ReadFileBytes(const std::string& path, std::uint64_t max_bytes) {
  const OpenFile file = OpenToRead(path);
  if (!file.ok()) return FileFailure(path, "open the file");
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t size, SizeOfRegular(path, file));
  if (size > max_bytes) {
    return InvalidArgument(path + ": holds " + std::to_string(size) + " bytes, expected at most " +
                           std::to_string(max_bytes));
  }
  return ReadExactly(path, file, 0, size);
}

Result<std::string> ReadFileRange(const std::string& path, std::uint64_t offset, std::uint64_t count) {
  const OpenFile file = OpenToRead(path);
  if (!file.ok()) return FileFailure(path, "open the file");
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t size, SizeOfRegular(path, file));
  if (offset > size || count > size - offset) {
    return InvalidArgument(path + ": holds " + std::to_string(size) + " bytes, expected " + std::to_string(count) +
                           " from byte " + std::to_string(offset) + " on");
  }
  return ReadExactly(path, file, offset, count);
}

Status WriteFileAtomically(const std::string& path, std::string_view bytes, Durability durability) {
  return WriteFileAtomically(path, std::span(&bytes, 1), durability);
}

Status WriteFileAtomically(const std::string& path, std::string_view bytes, const std::function<Status()>& last_look) {
  PendingFile file(path);
  DEPTHFARM_RETURN_IF_ERROR(WriteAll(file.temporary(), std::span(&bytes, 1), Durability::kCached));
  DEPTHFARM_RETURN_IF_ERROR(last_look());
  return file.Commit();
}

Status WriteFileAtomically(const std::string& path, std::span<const std::string_view> pieces, Durability durability) {
  PendingFile file(path);
  DEPTHFARM_RETURN_IF_ERROR(WriteAll(file.temporary(), pieces, durability));
  DEPTHFARM_RETURN_IF_ERROR(file.Commit());
  return durability == Durability::kSynced ? SyncFolderOf(path) : Status();
}

Status MakeDirectories(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return Unavailable(path + ": cannot make the folder: " + error.message());
  if (!std::filesystem::is_directory(path, error)) return Unavailable(path + ": is not a folder");
  return {};
}

}  // namespace depthfarm
