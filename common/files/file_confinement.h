#ifndef DEPTHFARM_COMMON_FILES_FILE_CONFINEMENT_H_
#define DEPTHFARM_COMMON_FILES_FILE_CONFINEMENT_H_

#include <filesystem>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// Folders and what may be done in them and below.
struct FileAccess {
  std::vector<std::filesystem::path> read;     // files are read, folders listed
  std::vector<std::filesystem::path> write;    // read, and files and folders are made, written, renamed, removed
  std::vector<std::filesystem::path> sockets;  // sockets are made and removed
};

// From now on the kernel lets this thread and all that it starts open no other files than these, and what the system's
// libraries read (names of hosts, time zones, other libraries), whichever links lead there; and run no program. Files
// that are open stay open. There is no way back. Uses Landlock: kUnavailable where the kernel has none (Linux 5.19 and
// newer have what is needed, unless it was left out or turned off) or where a folder cannot be opened.
[[nodiscard]] Status ConfineFiles(const FileAccess& access);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_FILES_FILE_CONFINEMENT_H_
