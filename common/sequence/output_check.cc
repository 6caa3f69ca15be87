#include "common/sequence/output_check.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/sequence/depth_manifest.h"
#include "common/sequence/json_fields.h"
#include "common/sequence/output_layout.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxManifestBytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 34;
constexpr std::size_t kMaxViews = 1'000'000;

using Listed = std::map<std::string, std::string>;  // path -> SHA-256 in hexadecimal

bool Exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

Status AddDepth(const std::string& directory, Listed& listed) {
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthManifest manifest, ReadDepthManifest(directory));
  for (const DepthManifestCamera& camera : manifest.cameras) {
    for (const auto* files : {&camera.files, &camera.confidence}) {
      for (const DepthManifestFile& file : *files) listed[file.path] = file.sha256;
    }
  }
  return {};
}

// Of views.json only the files are read: the rest is for those who use the views.
Status AddViews(const std::string& directory, Listed& listed) {
  const std::string path = (fs::path(directory) / kViewsManifestName).string();
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, ReadFileBytes(path, kMaxManifestBytes));
  Result<Json> json = ParseStrictJson(text);
  if (!json.ok()) return json.status().WithContext(path);
  const auto bad = [&](const std::string& what) { return InvalidArgument(path + ": " + what); };
  if (!json->is_object() || !json->contains("views") || !(*json)["views"].is_array()) {
    return bad("expected an object with a list 'views'");
  }
  const Json& views = (*json)["views"];
  if (views.size() > kMaxViews) return bad("'views' has " + std::to_string(views.size()) + " entries");
  for (const Json& view : views) {
    const bool right = view.is_object() && view.contains("file") && view["file"].is_string() &&
                       view.contains("sha256") && view["sha256"].is_string();
    if (!right) return bad("a view is " + Shortened(view) + ", expected an object with 'file' and 'sha256'");
    const auto file = view["file"].get<std::string>();
    if (!StaysInFolder(file)) return bad("file " + Shortened(view["file"]) + " is not below the folder");
    listed[file] = view["sha256"].get<std::string>();
  }
  return {};
}

// Regular files, links and whatever else is below one of the folders that a manifest speaks of, and is not listed.
void AddUnlisted(const fs::path& directory, const char* folder, const Listed& listed, OutputCheck& check) {
  std::error_code error;
  for (fs::recursive_directory_iterator entry(directory / folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->is_directory(error) && !entry->is_symlink(error)) continue;
    const std::string path = fs::path(entry->path()).lexically_relative(directory).string();
    if (!listed.contains(path)) check.unlisted.push_back(path);
  }
}

}  // namespace

Result<OutputCheck> CheckOutput(const std::string& directory, const std::function<bool()>& stop) {
  const fs::path root(directory);
  std::error_code ignored;
  if (!fs::is_directory(root, ignored)) return InvalidArgument(directory + ": is no folder");
  OutputCheck check;
  check.unfinished = Exists(root / kDepthJobMarker) || Exists(root / kViewsJobMarker);
  Listed listed;
  if (Exists(root / kDepthManifestName)) {
    check.manifests.emplace_back(kDepthManifestName);
    DEPTHFARM_RETURN_IF_ERROR(AddDepth(directory, listed));
  }
  if (Exists(root / kViewsManifestName)) {
    check.manifests.emplace_back(kViewsManifestName);
    DEPTHFARM_RETURN_IF_ERROR(AddViews(directory, listed));
  }
  if (check.manifests.empty()) {
    return InvalidArgument(
        directory + ": holds neither depth.json nor views.json" +
        (check.unfinished ? ": its job runs, or ended before it was done" : ": no job of depthfarm has written there"));
  }
  for (const auto& [path, sha256] : listed) {
    if (stop()) return Cancelled();
    ++check.files;
    const Result<std::string> bytes = ReadFileBytes((root / path).string(), kMaxFileBytes);
    if (!bytes.ok()) {
      (Exists(root / path) ? check.unreadable : check.missing).push_back(path);
    } else if (Hex(Sha256(*bytes)) != sha256) {
      check.changed.push_back(path);
    } else {
      check.bytes += bytes->size();
    }
  }
  for (const char* folder : {kDepthFolder, kConfidenceFolder}) {
    if (check.manifests.front() == kDepthManifestName) AddUnlisted(root, folder, listed, check);
  }
  if (check.manifests.back() == kViewsManifestName) AddUnlisted(root, kViewsFolder, listed, check);
  std::ranges::sort(check.unlisted);
  return check;
}

}  // namespace depthfarm
