#include "common/files/file_roots.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

Result<fs::path> FolderOf(const std::string& option, const std::string& name) {
  const auto refuse = [&](const std::string& why) { return InvalidArgument(option + " '" + name + "': " + why); };
  if (!fs::path(name).is_absolute()) return refuse("expected an absolute path");
  std::error_code error;
  fs::path folder = fs::canonical(name, error);
  if (error) return refuse(error.message());
  if (!fs::is_directory(folder, error)) return refuse("is not a folder");
  return folder;
}

Result<std::vector<fs::path>> FoldersOf(const std::string& option, const std::vector<std::string>& names) {
  std::vector<fs::path> folders;
  for (const std::string& name : names) {
    DEPTHFARM_ASSIGN_OR_RETURN(fs::path folder, FolderOf(option, name));
    folders.push_back(std::move(folder));
  }
  return folders;
}

bool IsBelow(const fs::path& path, const fs::path& folder) {
  return std::ranges::mismatch(folder, path).in1 == folder.end();
}

bool IsBelowOne(const fs::path& path, const std::vector<fs::path>& folders) {
  return std::ranges::any_of(folders, [&](const fs::path& folder) { return IsBelow(path, folder); });
}

// Where the path leads. What is not there yet is where its name says, but for a link: nobody knows what it will lead
// to.
Result<fs::path> Followed(const std::string& path) {
  if (!fs::path(path).is_absolute()) return InvalidArgument(path + ": expected an absolute path");
  std::error_code error;
  fs::path there;
  for (const fs::path& part : fs::path(path)) {
    there /= part;
    if (fs::exists(there, error)) continue;
    if (fs::is_symlink(fs::symlink_status(there, error)))
      return InvalidArgument(path + ": " + there.string() + " is a link that leads nowhere");
    break;
  }
  fs::path followed = fs::weakly_canonical(path, error);
  if (error) return Unavailable(path + ": cannot tell where it leads: " + error.message());
  return followed;
}

std::string Outside(const std::string& path, const fs::path& followed) {
  const bool moved = followed != fs::path(path).lexically_normal();
  return path + (moved ? ": leads to " + followed.string() + ", which" : ":") + " is outside of what jobs may ";
}

}  // namespace

Result<FileRoots> FileRoots::Of(const std::vector<std::string>& read, const std::vector<std::string>& write) {
  FileRoots roots;
  DEPTHFARM_ASSIGN_OR_RETURN(roots.read_, FoldersOf("--read-root", read));
  DEPTHFARM_ASSIGN_OR_RETURN(roots.write_, FoldersOf("--write-root", write));
  return roots;
}

std::string FileRoots::Names() const {
  std::string names;
  for (const fs::path& folder : read_) names += (names.empty() ? "" : ", ") + ("--read-root " + folder.string());
  for (const fs::path& folder : write_) names += (names.empty() ? "" : ", ") + ("--write-root " + folder.string());
  return names;
}

Status FileRoots::CheckRead(const std::string& path) const {
  if (!confined()) return {};
  DEPTHFARM_ASSIGN_OR_RETURN(const fs::path followed, Followed(path));
  if (IsBelowOne(followed, read_) || IsBelowOne(followed, write_)) return {};
  return InvalidArgument(Outside(path, followed) + "read on this worker (" + Names() + ")");
}

Status FileRoots::CheckWrite(const std::string& path) const {
  if (!confined()) return {};
  DEPTHFARM_ASSIGN_OR_RETURN(const fs::path followed, Followed(path));
  if (IsBelowOne(followed, write_)) return {};
  return InvalidArgument(Outside(path, followed) + "write on this worker (" + Names() + ")");
}

}  // namespace depthfarm
