#include "coordinator/fetching/fetched_folder.h"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <system_error>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/sequence/output_layout.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxMarkerBytes = 4096;
constexpr std::uint64_t kMaxManifestBytes = std::uint64_t{1} << 30;

bool Exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

Status RemoveAll(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  return error ? Unavailable(path.string() + ": cannot remove: " + error.message()) : Status();
}

Status Move(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  return error ? Unavailable(to.string() + ": cannot move the file there: " + error.message()) : Status();
}

}  // namespace

Result<FetchedFolder> FetchedFolder::Open(const fs::path& dir, const std::string& identity) {
  FetchedFolder folder(dir);
  const std::string mark = "results of a depthfarm job are fetched into this folder: " + identity + "\n";
  const std::string marker = (dir / kDepthJobMarker).string();
  if (Exists(marker)) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::string found, ReadFileBytes(marker, kMaxMarkerBytes));
    if (found != mark) {
      return InvalidArgument(dir.string() + ": belongs to another job, that writes there or was not finished (see " +
                             kDepthJobMarker + "): choose another folder or remove it");
    }
  } else if (Exists(dir / kDepthManifestName)) {
    DEPTHFARM_ASSIGN_OR_RETURN(folder.finished_, ReadFileBytes((dir / kDepthManifestName).string(), kMaxManifestBytes));
    return folder;
  } else {
    for (const char* name : {kDepthFolder, kConfidenceFolder}) {
      if (!Exists(dir / name)) continue;
      return InvalidArgument((dir / name).string() + ": exists and no job of depthfarm made it: choose another folder");
    }
    DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(dir.string()));
    DEPTHFARM_RETURN_IF_ERROR(WriteFileAtomically(marker, mark));
  }
  DEPTHFARM_RETURN_IF_ERROR(folder.Lock(marker));
  DEPTHFARM_RETURN_IF_ERROR(RemoveAll(dir / kStagingFolder));  // of a fetch that was killed
  return folder;
}

Status FetchedFolder::Lock(const std::string& marker) {
  marker_ = std::make_unique<OpenFile>(open(marker.c_str(), O_RDONLY | O_CLOEXEC));
  if (!marker_->ok()) return FileFailure(marker, "open");
  if (flock(marker_->descriptor(), LOCK_EX | LOCK_NB) == 0) return {};
  if (errno == EWOULDBLOCK) return InvalidArgument(dir_.string() + ": another depthfarm fetch writes there just now");
  return FileFailure(marker, "lock");
}

bool FetchedFolder::Has(const std::string& file, const FileDigest& digest) const {
  const std::string path = (dir_ / file).string();
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size != digest.bytes) return false;
  const Result<std::string> bytes = ReadFileBytes(path, digest.bytes);
  return bytes.ok() && Sha256(*bytes) == digest.sha256;
}

Status FetchedFolder::Write(const std::string& file, std::string_view bytes) const {
  const fs::path target = dir_ / file;
  const fs::path staging = dir_ / kStagingFolder / "fetch";
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(staging.string()));
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(target.parent_path().string()));
  DEPTHFARM_RETURN_IF_ERROR(WriteFileAtomically((staging / target.filename()).string(), bytes));
  return Move(staging / target.filename(), target);
}

Status FetchedFolder::Finish(const std::string& manifest) const {
  DEPTHFARM_RETURN_IF_ERROR(WriteFileAtomically((dir_ / kDepthManifestName).string(), manifest));
  DEPTHFARM_RETURN_IF_ERROR(RemoveAll(dir_ / kStagingFolder));
  return RemoveAll(dir_ / kDepthJobMarker);
}

}  // namespace depthfarm
