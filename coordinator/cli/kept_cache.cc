#include "coordinator/cli/kept_cache.h"

#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "common/files/atomic_file.h"
#include "common/files/user_folders.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kGibibyte = std::uint64_t{1} << 30;

// Of linux/magic.h and the kernel modules of those that are not in it.
constexpr std::array<std::uint32_t, 12> kNetworkTypes = {
    0x6969,      // NFS
    0x517B,      // SMB
    0xFF534D42,  // CIFS
    0xFE534D42,  // SMB 2
    0x5346414F,  // AFS
    0x00C36400,  // Ceph
    0x0BD00BD0,  // Lustre
    0x47504653,  // GPFS
    0x19830326,  // BeeGFS
    0x01021997,  // 9P
    0x65735546,  // FUSE: sshfs, GlusterFS
    0x73757245,  // Coda
};

// Backup programs leave out a folder that has this file (Cache Directory Tagging Specification).
constexpr const char* kTagName = "CACHEDIR.TAG";
constexpr const char* kTag =
    "Signature: 8a477f597d28d172789f06886806bc55\n"
    "# Artifacts of depthfarm run, kept to save work that was done before; may be removed while none runs.\n"
    "# For information about cache directory tags see https://bford.info/cachedir/\n";

// The folder, or the nearest one above it that is there.
fs::path NearestExisting(fs::path path) {
  std::error_code ignored;
  while (path.has_relative_path() && !fs::exists(path, ignored)) path = path.parent_path();
  return path;
}

std::string Because(const fs::path& folder, const std::string& reason) {
  return "nothing is kept for the next run in " + folder.string() + ", " + reason +
         "; --cache-dir names another folder";
}

// The user's, unless `note` tells why not.
Status MakeOwn(const fs::path& folder, std::string& note) {
  struct stat above {};
  const fs::path existing = NearestExisting(folder);
  // Nobody's cache goes into the home of another user (sudo keeps HOME), but it may lie below what is the system's.
  if (::stat(existing.c_str(), &above) == 0 && above.st_uid != ::geteuid() &&
      (above.st_uid != 0 || existing == folder)) {
    note = Because(folder, "which belongs to another user");
    return {};
  }
  struct statfs file_system {};
  if (::statfs(existing.c_str(), &file_system) == 0 && IsNetworkFileSystem(file_system.f_type)) {
    note = Because(folder, "which is on a network file system");
    return {};
  }
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(folder.parent_path().string()));
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    return Unavailable("cannot make folder " + folder.string() + ": " + std::generic_category().message(errno));
  return {};
}

std::uint64_t SizeOfFileSystem(const fs::path& folder) {
  struct statfs info {};
  if (::statfs(folder.c_str(), &info) != 0) return 0;
  return static_cast<std::uint64_t>(info.f_blocks) * static_cast<std::uint64_t>(info.f_bsize);
}

}  // namespace

std::uint64_t KeptCacheBytes(std::uint64_t file_system_bytes) {
  return std::clamp(file_system_bytes / 10, kGibibyte, 8 * kGibibyte);
}

bool IsNetworkFileSystem(std::int64_t type) {
  return std::ranges::find(kNetworkTypes, static_cast<std::uint32_t>(type)) != kNetworkTypes.end();
}

Result<KeptCache> OpenKeptCache(const std::string& asked) {
  KeptCache cache;
  if (asked.empty()) {
    const Result<std::string> user = CacheFolder();
    if (!user.ok()) {
      cache.note = "nothing is kept for the next run: " + user.status().message() + "; --cache-dir names a folder";
      return cache;
    }
    const fs::path folder = fs::path(*user) / "artifacts";
    if (const Status made = MakeOwn(folder, cache.note); !made.ok())
      cache.note = Because(folder, "since: " + made.message());
    if (!cache.note.empty()) return cache;
    cache.folder = folder;
    const fs::path tag = folder.parent_path() / kTagName;
    std::error_code ignored;
    // Of no use to us: a failure shows where the folder is needed.
    if (!fs::exists(tag, ignored)) (void)WriteFileAtomically(tag.string(), kTag);
  } else {
    cache.folder = fs::absolute(asked).lexically_normal();
    if (const Status made = MakeDirectories(cache.folder.string()); !made.ok())
      return InvalidArgument("--cache-dir: " + made.message());
  }
  cache.bytes = KeptCacheBytes(SizeOfFileSystem(cache.folder));
  return cache;
}

}  // namespace depthfarm
