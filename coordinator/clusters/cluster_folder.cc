#include "coordinator/clusters/cluster_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/files/atomic_file.h"
#include "common/files/user_folders.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOptions = "options.json";
constexpr const char* kRecord = "cluster.json";
constexpr const char* kDown = "down";
constexpr std::uint64_t kMostRecordBytes = std::uint64_t{1} << 20;

Status CheckPrivate(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0 || !S_ISDIR(info.st_mode)) {
    return InvalidArgument("there is no folder " + path.string());
  }
  if (info.st_uid != ::geteuid() || (info.st_mode & 077) != 0) {
    return InvalidArgument("others may enter " + path.string() +
                           ", which holds keys: chmod 700 it, or name another folder");
  }
  return {};
}

}  // namespace

Result<std::string> ClusterFolder::DefaultPath(const std::string& name) {
  const Result<std::string> folder = StateFolder();
  if (!folder.ok()) return InvalidArgument(folder.status().message() + ": name a folder with --state");
  return *folder + "/clusters/" + name;
}

Result<ClusterFolder> ClusterFolder::Make(const fs::path& path) {
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(path.parent_path().string()));
  if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST) {
    return Unavailable("cannot make folder " + path.string() + ": " + std::strerror(errno));
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckPrivate(path));
  ClusterFolder folder(path);
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(folder.logs().string()));
  return folder;
}

Result<ClusterFolder> ClusterFolder::Open(const fs::path& path) {
  if (!fs::exists(path / kOptions)) {
    return InvalidArgument("there is no cluster in " + path.string() + ": depthfarm cluster up makes one");
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckPrivate(path));
  return ClusterFolder(path);
}

Status ClusterFolder::WriteOptions(const ClusterOptions& options) const {
  return WriteFileAtomically((path_ / kOptions).string(), ClusterOptionsToJson(options));
}

Result<ClusterOptions> ClusterFolder::ReadOptions() const {
  const std::string file = (path_ / kOptions).string();
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, ReadFileBytes(file, kMostRecordBytes));
  Result<ClusterOptions> options = ClusterOptionsFromJson(text);
  if (!options.ok()) return options.status().WithContext(file);
  return options;
}

Result<std::optional<ClusterRecord>> ClusterFolder::ReadRecord() const {
  const std::string file = (path_ / kRecord).string();
  if (!fs::exists(file)) return std::optional<ClusterRecord>();
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, ReadFileBytes(file, kMostRecordBytes));
  try {
    const nlohmann::json json = nlohmann::json::parse(text);
    ClusterRecord record;
    DEPTHFARM_ASSIGN_OR_RETURN(record.options, ClusterOptionsFromJson(json.at("options").dump()));
    json.at("coordinator").get_to(record.coordinator);
    json.at("keysDir").get_to(record.keys_dir);
    json.at("instance").get_to(record.instance);
    json.at("managerHost").get_to(record.manager_host);
    json.at("managerPid").get_to(record.manager_pid);
    json.at("started").get_to(record.started);
    return std::optional(std::move(record));
  } catch (const nlohmann::json::exception& error) {
    return Corrupt(file + " is no record of a cluster: " + error.what());
  }
}

Status ClusterFolder::WriteRecord(const ClusterRecord& record) const {
  nlohmann::ordered_json json;
  json["coordinator"] = record.coordinator;
  json["keysDir"] = record.keys_dir;
  json["instance"] = record.instance;
  json["managerHost"] = record.manager_host;
  json["managerPid"] = record.manager_pid;
  json["started"] = record.started;
  json["options"] = nlohmann::ordered_json::parse(ClusterOptionsToJson(record.options));
  return WriteFileAtomically((path_ / kRecord).string(), json.dump(2) + "\n");
}

void ClusterFolder::RemoveRecord() const {
  std::error_code ignored;  // a record that stays is found to have no manager
  fs::remove(path_ / kRecord, ignored);
}

ClusterFolder::Lock::~Lock() { ::close(descriptor_); }

Result<std::unique_ptr<ClusterFolder::Lock>> ClusterFolder::TryLock() const {
  const std::string file = (path_ / "lock").string();
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) return Unavailable("cannot open " + file + ": " + std::strerror(errno));
  auto lock = std::make_unique<Lock>(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return lock;
  if (errno == EWOULDBLOCK) return std::unique_ptr<Lock>();
  return Unavailable("cannot lock " + file + ": " + std::strerror(errno));
}

Status ClusterFolder::AskDown() const { return WriteFileAtomically((path_ / kDown).string(), ""); }

bool ClusterFolder::AskedDown() const {
  std::error_code ignored;  // not seen, not asked
  return fs::exists(path_ / kDown, ignored);
}

void ClusterFolder::ForgetDown() const {
  std::error_code ignored;
  fs::remove(path_ / kDown, ignored);
}

}  // namespace depthfarm
