#ifndef DEPTHFARM_TESTS_SYSTEM_SMALL_DISK_H_
#define DEPTHFARM_TESTS_SYSTEM_SMALL_DISK_H_

#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace depthfarm::system_test {

// A folder that is a disk of its own, in memory, of a size such as "96k". It is mounted in a mount namespace of this
// process's own: nobody sees it but this process and those that it starts from then on, and it is gone with them.
class SmallDisk {
 public:
  SmallDisk(const std::filesystem::path& folder, const std::string& size) : folder_(folder) {
    std::filesystem::create_directories(folder);
    const bool mounted = ::unshare(CLONE_NEWNS) == 0 &&
                         ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                         ::mount("tmpfs", folder.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
    if (!mounted) problem_ = "cannot mount here: " + std::generic_category().message(errno);
  }
  // What still has a file of it open keeps it for itself.
  ~SmallDisk() {
    if (problem_.empty()) ::umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  // Why there is none; empty if there is.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] std::string operator/(const std::string& name) const { return (folder_ / name).string(); }

  // False while somebody has a file open to write.
  [[nodiscard]] bool MakeReadOnly() const { return Remount(MS_RDONLY); }
  [[nodiscard]] bool MakeWritable() const { return Remount(0); }

  // Takes all the room that is left.
  void Fill() const {
    std::ofstream other(Filler(), std::ios::binary | std::ios::app);
    const std::string page(4096, 'x');
    while (other.write(page.data(), static_cast<std::streamsize>(page.size())).flush()) {
    }
  }
  void MakeRoom() const { std::filesystem::remove(Filler()); }

 private:
  [[nodiscard]] std::filesystem::path Filler() const { return folder_ / "other"; }
  [[nodiscard]] bool Remount(unsigned long flags) const {
    return ::mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT | flags, nullptr) == 0;
  }

  std::filesystem::path folder_;
  std::string problem_;
};

}  // namespace depthfarm::system_test

#endif  // DEPTHFARM_TESTS_SYSTEM_SMALL_DISK_H_
