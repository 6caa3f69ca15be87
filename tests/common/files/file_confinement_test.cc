#include "common/files/file_confinement.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/landlock.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "common/files/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing_support::TemporaryFolder;

bool KernelHasLandlock() {
  return syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) >= 2;
}

bool CanRead(const std::string& path) { return ReadFileBytes(path, 1U << 20U).ok(); }
bool CanWrite(const std::string& path) { return WriteFileAtomically(path, "x").ok(); }

bool CanBind(const std::string& path) {
  const int end = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.c_str(), path.size());
  const bool bound = bind(end, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(end);
  return bound && unlink(path.c_str()) == 0;
}

// What may be read is in/, written out/, a socket be made in run/; secret/ is none of them.
class ConfinementTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!KernelHasLandlock()) GTEST_SKIP() << "this kernel has no Landlock";
    for (const char* name : {"in", "out/a", "out/b", "run", "secret"}) fs::create_directories(folder_.path() / name);
    folder_.Write("in/picture", "a picture");
    folder_.Write("secret/key", "a key");
    fs::create_symlink(folder_.File("secret/key"), folder_.File("in/link"));
    fs::create_directory_symlink(folder_.File("secret"), folder_.File("out/link"));
  }

  // In a process of its own, since nothing gives the rights back: the number of the first check that fails, or 0.
  [[nodiscard]] int Confined(const std::function<void(const std::function<void(int, bool)>&)>& checks) const {
    const pid_t child = fork();
    if (child == 0) {
      const FileAccess access{{folder_.File("in")}, {folder_.File("out")}, {folder_.File("run")}};
      if (!ConfineFiles(access).ok()) _exit(255);
      checks([](int number, bool holds) {
        if (!holds) _exit(number);
      });
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 254;
  }

  TemporaryFolder folder_;
};

TEST_F(ConfinementTest, LeavesWhatIsAllowed) {
  EXPECT_EQ(Confined([&](const auto& check) {
              check(1, CanRead(folder_.File("in/picture")));
              check(2, CanWrite(folder_.File("out/a/new")));
              check(3, CanRead(folder_.File("out/a/new")));
              // As the files of an attempt take their place.
              check(4, rename(folder_.File("out/a/new").c_str(), folder_.File("out/b/new").c_str()) == 0);
              check(5, fs::remove_all(folder_.File("out/b")) == 2);
              check(6, CanBind(folder_.File("run/socket")));
              check(7, CanRead("/etc/hosts"));
              bool in_a_thread = false;
              std::thread([&] { in_a_thread = CanRead(folder_.File("in/picture")); }).join();
              check(8, in_a_thread);
            }),
            0);
}

TEST_F(ConfinementTest, TakesAllElseAway) {
  EXPECT_EQ(Confined([&](const auto& check) {
              check(1, !CanRead(folder_.File("secret/key")));
              check(2, !CanRead(folder_.File("in/link")));
              check(3, !CanRead(folder_.File("out/link/key")));
              check(4, !CanRead("/etc/passwd"));
              check(5, !CanWrite(folder_.File("in/new")));
              check(6, !CanWrite(folder_.File("out/link/new")));
              check(7, !CanWrite(folder_.File("secret/new")));
              check(8, unlink(folder_.File("in/picture").c_str()) != 0);
              check(9, rename(folder_.File("in/picture").c_str(), folder_.File("out/picture").c_str()) != 0);
              check(10, !CanBind(folder_.File("out/socket")));
              check(11, open(folder_.File("secret").c_str(), O_RDONLY | O_DIRECTORY) < 0);
              check(12, symlink("/etc/passwd", folder_.File("out/new link").c_str()) != 0);
              execl("/bin/true", "/bin/true", nullptr);
              check(13, errno == EACCES);
              bool in_a_thread = true;
              std::thread([&] { in_a_thread = CanRead(folder_.File("secret/key")); }).join();
              check(14, !in_a_thread);
            }),
            0);
  EXPECT_EQ(fs::file_size(folder_.File("in/picture")), 9U);
}

TEST_F(ConfinementTest, AMissingFolderIsAnErrorBeforeAnythingIsTakenAway) {
  const Status status = ConfineFiles({{folder_.File("none")}, {}, {}});
  EXPECT_EQ(status.code(), ErrorCode::kUnavailable);
  EXPECT_TRUE(CanRead(folder_.File("secret/key")));
}

}  // namespace
}  // namespace depthfarm
