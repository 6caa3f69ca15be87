#include "worker/execution/output_folder.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/files/pending_file.h"
#include "common/sequence/depth_manifest.h"
#include "common/sequence/output_layout.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRemoved = ".depthfarm-removed-";
constexpr const char* kUnfinished = ".tmp-";  // PendingFile
constexpr std::uint64_t kMaxMarkerBytes = 1000;

std::string MarkerText(std::uint64_t run, bool ready) {
  return "a depthfarm job writes into this folder: run " + std::to_string(run) + (ready ? "\n" : ", not ready yet\n");
}

// One component of a path: it cannot lead anywhere else.
bool IsPlainName(std::string_view name) {
  return !name.empty() && name != "." && name != ".." && std::ranges::none_of(name, [](char c) {
    return c == '/' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  });
}

Status RemoveAll(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) return Unavailable(path.string() + ": cannot remove: " + error.message());
  return {};
}

bool Exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

// Ok when the file holds what `expected` says.
Status CheckContent(const fs::path& path, const OutputFile& expected) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, ReadFileBytes(path.string(), expected.bytes));
  if (Sha256(bytes) == expected.sha256) return {};
  return Corrupt(path.string() + ": its SHA-256 is not that of the file that was written");
}

}  // namespace

Result<OutputFolder> OutputFolder::At(const std::string& dir, OutputContent content, FolderClaim claim) {
  const fs::path path(dir);
  const bool climbs = std::ranges::find(path, fs::path("..")) != path.end();
  if (!path.is_absolute() || climbs || path == path.root_path()) {
    return InvalidArgument("output folder '" + dir + "': expected an absolute path of a folder without '..'");
  }
  return OutputFolder(path, content, std::move(claim));
}

fs::path OutputFolder::Manifest() const {
  return dir_ / (content_ == OutputContent::kDepth ? kDepthManifestName : kViewsManifestName);
}

// Of its own for each content: a job that was cancelled says nothing of what else is in the folder.
fs::path OutputFolder::Marker() const {
  return dir_ / (content_ == OutputContent::kDepth ? kDepthJobMarker : kViewsJobMarker);
}

std::vector<fs::path> OutputFolder::Folders() const {
  if (content_ == OutputContent::kViews) return {dir_ / kViewsFolder};
  return {dir_ / kDepthFolder, dir_ / kConfidenceFolder};
}

Result<OutputFolder::Owner> OutputFolder::ReadMarker() const {
  if (!Exists(Marker())) return Owner::kNobody;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, ReadFileBytes(Marker().string(), kMaxMarkerBytes));
  // Of a coordinator that does not tell runs apart nobody knows which one it was made ready for.
  if (text == MarkerText(claim_.run, true)) return claim_.run == 0 ? Owner::kOursUnready : Owner::kOurs;
  return text == MarkerText(claim_.run, false) ? Owner::kOursUnready : Owner::kOther;
}

Status OutputFolder::WriteMarker(bool ready) const {
  return WriteFileAtomically(Marker().string(), MarkerText(claim_.run, ready), [this] { return CheckLease(); });
}

Status OutputFolder::CheckLease() const {
  if (!claim_.still_leased || claim_.still_leased()) return {};
  return {ErrorCode::kLeaseExpired, dir_.string() + ": left alone, since the lease of the task ran out"};
}

Status OutputFolder::CheckOurs() const {
  DEPTHFARM_ASSIGN_OR_RETURN(const Owner owner, ReadMarker());
  if (owner == Owner::kNobody)
    return Unavailable(dir_.string() + ": belongs to no job (" + Marker().filename().string() + " is missing)");
  if (owner == Owner::kOther) return Unavailable(dir_.string() + ": belongs to another job by now");
  return CheckLease();
}

Status OutputFolder::Remove(const fs::path& path) const {
  if (!Exists(path)) return {};
  DEPTHFARM_RETURN_IF_ERROR(CheckLease());
  const fs::path aside = dir_ / (kRemoved + UniqueSuffix());
  std::error_code error;
  fs::rename(path, aside, error);
  if (error && Exists(path)) return Unavailable(path.string() + ": cannot remove: " + error.message());
  // Gone for whoever looks; what cannot be removed here is a leftover.
  if (!error) (void)RemoveAll(aside);
  return {};
}

// Of workers that ended while they removed or wrote something. Another one may be at it.
void OutputFolder::RemoveLeftovers() const {
  const std::string unfinished_marker = Marker().filename().string() + kUnfinished;
  const std::string unfinished_manifest = Manifest().filename().string() + kUnfinished;
  std::error_code error;
  for (fs::directory_iterator entry(dir_, error); !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(kRemoved) || name.starts_with(unfinished_marker) || name.starts_with(unfinished_manifest))
      (void)RemoveAll(entry->path());
  }
}

// "depth/<camera>/<file>", "confidence/<camera>/<file>" or "views/<file>".
Status OutputFolder::CheckOutputPath(const std::string& path) const {
  std::vector<std::string_view> names;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    names.push_back(std::string_view(path).substr(begin, end - begin));
    begin = end + 1;
  }
  const bool plain = std::ranges::all_of(names, IsPlainName);
  const bool views = content_ == OutputContent::kViews;
  const bool known =
      views ? names.front() == kViewsFolder : names.front() == kDepthFolder || names.front() == kConfidenceFolder;
  if (plain && known && names.size() == (views ? 2 : 3)) return {};
  return InvalidArgument("output file '" + path + "': expected " +
                         (views ? "views/<file>" : "depth/<camera>/<file> or confidence/<camera>/<file>"));
}

// A job that had begun has asked before. Every depth.json and views.json names what is in the first folder; confidence
// maps, of which somebody may have others, only if there are any.
bool OutputFolder::Owns(const fs::path& folder) const {
  if (Exists(Marker())) return true;
  if (!Exists(Manifest()) || folder == Folders().front()) return Exists(Manifest());
  const Result<DepthManifest> manifest = ReadDepthManifest(dir_.string());
  return manifest.ok() && std::ranges::any_of(manifest->cameras, [](const DepthManifestCamera& camera) {
           return !camera.confidence.empty();
         });
}

Status OutputFolder::Prepare() const {
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(dir_.string()));
  DEPTHFARM_ASSIGN_OR_RETURN(const Owner owner, ReadMarker());
  if (owner == Owner::kOurs) return {};  // by an earlier attempt: frames may be in place by now
  for (const fs::path& folder : Folders()) {
    if (!Exists(folder) || Owns(folder)) continue;
    return InvalidArgument(folder.string() + ": exists and was not made by depthfarm (no " +
                           Manifest().filename().string() + " beside it that names it): choose another folder");
  }
  // The marker first: a worker that dies below leaves a folder that is still known to be ours.
  DEPTHFARM_RETURN_IF_ERROR(WriteMarker(false));
  DEPTHFARM_RETURN_IF_ERROR(Remove(Manifest()));
  for (const fs::path& folder : Folders()) DEPTHFARM_RETURN_IF_ERROR(Remove(folder));
  DEPTHFARM_RETURN_IF_ERROR(Remove(dir_ / kStagingFolder));
  RemoveLeftovers();
  return WriteMarker(true);
}

Status OutputFolder::Resume(const std::vector<OutputFile>& files) const {
  constexpr std::size_t kReadEach = 16;
  const auto gone = [](const fs::path& path, const std::string& what) {
    return InvalidArgument(path.string() + ": " + what + ", so the job cannot go on: submit it again");
  };
  DEPTHFARM_ASSIGN_OR_RETURN(const Owner owner, ReadMarker());
  if (owner == Owner::kOurs) return {};
  // Without a marker its manifest was written, and the coordinator never heard of it.
  if (!Exists(Marker()) && !Exists(Manifest())) return gone(dir_, "belongs to no job any more");
  for (std::size_t i = 0; i < files.size(); ++i) {
    DEPTHFARM_RETURN_IF_ERROR(CheckOutputPath(files[i].path));
    const fs::path path = dir_ / files[i].path;
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(path, error);
    if (error) return gone(path, "is missing");
    if (bytes != files[i].bytes || (i % kReadEach == 0 && !CheckContent(path, files[i]).ok()))
      return gone(path, "is not what the job wrote");
  }
  DEPTHFARM_RETURN_IF_ERROR(WriteMarker(false));
  DEPTHFARM_RETURN_IF_ERROR(Remove(Manifest()));
  DEPTHFARM_RETURN_IF_ERROR(Remove(dir_ / kStagingFolder));
  RemoveLeftovers();
  return WriteMarker(true);
}

Result<fs::path> OutputFolder::StagingOf(const std::string& staging) const {
  if (!IsPlainName(staging)) return InvalidArgument("staging folder '" + staging + "': expected a plain name");
  return dir_ / kStagingFolder / staging;
}

Status OutputFolder::Stage(const std::string& staging, const std::string& path, std::string_view bytes) const {
  DEPTHFARM_RETURN_IF_ERROR(CheckOutputPath(path));
  DEPTHFARM_ASSIGN_OR_RETURN(const fs::path folder, StagingOf(staging));
  // An attempt that outlives its job must not make folders in what is a finished result.
  DEPTHFARM_RETURN_IF_ERROR(CheckOurs());
  const fs::path file = folder / path;
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(file.parent_path().string()));
  return WriteFileAtomically(file.string(), bytes);
}

Status OutputFolder::Commit(const std::string& staging, const std::vector<OutputFile>& files) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const fs::path folder, StagingOf(staging));
  for (const OutputFile& file : files) DEPTHFARM_RETURN_IF_ERROR(CheckOutputPath(file.path));
  for (const OutputFile& file : files) DEPTHFARM_RETURN_IF_ERROR(CommitFile(folder, file));
  return Remove(folder);
}

Status OutputFolder::CommitFile(const fs::path& staging, const OutputFile& file) const {
  DEPTHFARM_RETURN_IF_ERROR(CheckOurs());
  const fs::path source = staging / file.path;
  const fs::path target = dir_ / file.path;
  if (!Exists(source)) {
    if (Exists(target)) return CheckContent(target, file);  // an earlier attempt of this commit got that far
    return Unavailable(source.string() + ": is missing, and so is " + target.string());
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckContent(source, file));
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(target.parent_path().string()));
  DEPTHFARM_RETURN_IF_ERROR(CheckLease());
  std::error_code error;
  fs::rename(source, target, error);
  if (!error) return {};
  // Two attempts of one commit: the other one may have moved the file between our look and our rename.
  if (Exists(target) && CheckContent(target, file).ok()) return {};
  return Unavailable(target.string() + ": cannot move the file there: " + error.message());
}

Status OutputFolder::Finish(std::string_view manifest) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const Owner owner, ReadMarker());
  if (owner == Owner::kNobody && Exists(Manifest())) {
    const Result<std::string> written = ReadFileBytes(Manifest().string(), manifest.size());
    if (written.ok() && *written == manifest) return {};  // by an earlier attempt
  }
  DEPTHFARM_RETURN_IF_ERROR(WriteFileAtomically(Manifest().string(), manifest, [this] { return CheckOurs(); }));
  DEPTHFARM_RETURN_IF_ERROR(Remove(dir_ / kStagingFolder));
  RemoveLeftovers();
  DEPTHFARM_RETURN_IF_ERROR(CheckOurs());
  return RemoveAll(Marker());
}

Status OutputFolder::RemoveStaging() const {
  DEPTHFARM_RETURN_IF_ERROR(Remove(dir_ / kStagingFolder));
  RemoveLeftovers();
  return {};
}

}  // namespace depthfarm
