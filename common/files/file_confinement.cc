#include "common/files/file_confinement.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <string>
#include <system_error>

#include "common/files/open_file.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

// Rights that newer kernels know than the headers this is built with.
constexpr std::uint64_t kTruncate = std::uint64_t{1} << 14U;     // of interface 3
constexpr std::uint64_t kIoctlDevice = std::uint64_t{1} << 15U;  // of interface 5

constexpr std::uint64_t kReadFile = LANDLOCK_ACCESS_FS_READ_FILE;
constexpr std::uint64_t kRead = kReadFile | LANDLOCK_ACCESS_FS_READ_DIR;
// Of files alone: a rule for a file may not name others.
constexpr std::uint64_t kOfFiles = LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE | kReadFile | kTruncate;
constexpr std::uint64_t kWrite = kRead | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                                 LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_DIR |
                                 LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_REFER | kTruncate;
constexpr std::uint64_t kSockets = LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_REMOVE_FILE;
constexpr std::uint64_t kEverything = kWrite | kSockets | LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
                                      LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK |
                                      LANDLOCK_ACCESS_FS_MAKE_SYM | kIoctlDevice;

// What libraries open while a program runs: to find hosts by name, the local time, further libraries. Nothing in them
// is secret. /etc as a whole is not among them: keys may be there.
constexpr const char* kOfTheSystem[] = {"/usr",
                                        "/lib",
                                        "/lib64",
                                        "/etc/hosts",
                                        "/etc/host.conf",
                                        "/etc/resolv.conf",
                                        "/etc/nsswitch.conf",
                                        "/etc/gai.conf",
                                        "/etc/services",
                                        "/etc/localtime",
                                        "/etc/ld.so.cache",
                                        "/dev/null",
                                        "/dev/urandom",
                                        "/run/systemd/resolve",
                                        "/proc/cpuinfo",
                                        "/proc/meminfo",
                                        "/sys/devices/system/cpu",
                                        "/sys/fs/cgroup"};

std::string Reason() { return std::generic_category().message(errno); }

// The rights that this kernel can take away; 0 where it has no Landlock that lets files be renamed from folder to
// folder.
std::uint64_t KnownRights() {
  const auto version = syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  if (version < 2) return 0;
  std::uint64_t rights = kEverything;
  if (version < 3) rights &= ~kTruncate;
  if (version < 5) rights &= ~kIoctlDevice;
  return rights;
}

Status Allow(const OpenFile& rules, const fs::path& path, std::uint64_t rights) {
  const OpenFile opened(open(path.c_str(), O_PATH | O_CLOEXEC));
  if (!opened.ok()) return FileFailure(path.string(), "open it");
  struct stat facts {};
  if (fstat(opened.descriptor(), &facts) != 0) return FileFailure(path.string(), "examine it");
  landlock_path_beneath_attr rule{};
  rule.allowed_access = S_ISDIR(facts.st_mode) ? rights : rights & kOfFiles;
  rule.parent_fd = opened.descriptor();
  if (syscall(SYS_landlock_add_rule, rules.descriptor(), LANDLOCK_RULE_PATH_BENEATH, &rule, 0) != 0)
    return FileFailure(path.string(), "allow access to it");
  return {};
}

}  // namespace

Status ConfineFiles(const FileAccess& access) {
  const std::uint64_t known = KnownRights();
  if (known == 0) {
    return Unavailable(
        "cannot bound which files this process opens: the kernel has no Landlock (Linux 5.19 or newer has it, unless "
        "it is missing in the list lsm= of the kernel's command line)");
  }
  landlock_ruleset_attr handled{};
  handled.handled_access_fs = known;
  const OpenFile rules(static_cast<int>(syscall(SYS_landlock_create_ruleset, &handled, sizeof(handled), 0)));
  if (!rules.ok()) return Unavailable("cannot bound which files this process opens: " + Reason());
  for (const char* path : kOfTheSystem) {
    std::error_code error;
    if (fs::exists(path, error)) DEPTHFARM_RETURN_IF_ERROR(Allow(rules, path, kRead & known));
  }
  for (const fs::path& path : access.read) DEPTHFARM_RETURN_IF_ERROR(Allow(rules, path, kRead & known));
  for (const fs::path& path : access.write) DEPTHFARM_RETURN_IF_ERROR(Allow(rules, path, kWrite & known));
  for (const fs::path& path : access.sockets) DEPTHFARM_RETURN_IF_ERROR(Allow(rules, path, kSockets & known));
  // Else a program with more rights than this one could be made to act in its name.
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || syscall(SYS_landlock_restrict_self, rules.descriptor(), 0) != 0)
    return Unavailable("cannot bound which files this process opens: " + Reason());
  return {};
}

}  // namespace depthfarm
