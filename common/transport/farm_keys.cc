#include "common/transport/farm_keys.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

namespace depthfarm {
namespace {

constexpr std::array kRoles = {Role::kWork, Role::kSubmit, Role::kAdmin};
constexpr std::size_t kDefaultNameCharacters = 8;

Status CreatePair(const std::filesystem::path& dir, const std::string& name, std::string& public_key) {
  DEPTHFARM_ASSIGN_OR_RETURN(const CurveKeys keys, GenerateCurveKeys());
  DEPTHFARM_RETURN_IF_ERROR(WriteSecretKey(dir / (name + ".key"), keys.secret_key));
  DEPTHFARM_RETURN_IF_ERROR(WritePublicKey(dir / (name + ".pub"), keys.public_key));
  public_key = keys.public_key;
  return {};
}

Result<CurveKeys> ReadPair(const std::filesystem::path& dir, const std::string& name) {
  CurveKeys keys;
  DEPTHFARM_ASSIGN_OR_RETURN(keys.secret_key, ReadSecretKey(dir / (name + ".key")));
  DEPTHFARM_ASSIGN_OR_RETURN(keys.public_key, ReadPublicKey(dir / (name + ".pub")));
  return keys;
}

Status CheckNothingThere(const std::filesystem::path& dir) {
  for (const char* name :
       {"coordinator.key", "coordinator.pub", "worker.key", "worker.pub", "client.key", "client.pub", "authorized"}) {
    std::error_code error;
    if (std::filesystem::exists(std::filesystem::symlink_status(dir / name, error))) {
      return InvalidArgument((dir / name).string() + " exists already: keys are never replaced");
    }
  }
  return {};
}

}  // namespace

std::string_view RoleName(Role role) {
  switch (role) {
    case Role::kWork:
      return "work";
    case Role::kSubmit:
      return "submit";
    case Role::kAdmin:
      return "admin";
  }
  return "unknown";
}

Result<Role> RoleOfUser(std::string_view user_id) {
  const std::string_view name = user_id.substr(0, user_id.find(':'));
  for (const Role role : kRoles) {
    if (name.size() < user_id.size() && name == RoleName(role)) return role;
  }
  return InvalidArgument("user '" + std::string(user_id) +
                         "' has no role: expected work:, submit: or admin: and a name");
}

Status CreateFarmKeys(const std::filesystem::path& dir) {
  std::error_code error;
  const bool made = std::filesystem::create_directories(dir, error);
  if (error) return Unavailable("cannot make folder " + dir.string() + ": " + error.message());
  DEPTHFARM_RETURN_IF_ERROR(CheckNothingThere(dir));
  // A folder that was there keeps its mode, others may use it for something else; the keys are closed in any case.
  if (made && ::chmod(dir.c_str(), 0700) != 0) {
    return Unavailable("cannot close folder " + dir.string() + " to others: " + std::strerror(errno));
  }
  std::string coordinator;
  std::string worker;
  std::string client;
  DEPTHFARM_RETURN_IF_ERROR(CreatePair(dir, "coordinator", coordinator));
  DEPTHFARM_RETURN_IF_ERROR(CreatePair(dir, "worker", worker));
  DEPTHFARM_RETURN_IF_ERROR(CreatePair(dir, "client", client));
  return WritePublicText(dir / "authorized", "# <role> <public key> [name]; roles: work, submit, admin\nwork " +
                                                 worker + " worker\nadmin " + client + " client\n");
}

Result<AllowedKeys> ReadAuthorized(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return InvalidArgument("cannot read the list of authorized keys " + file.string());
  struct stat info {};
  if (::stat(file.c_str(), &info) != 0 || (info.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    return InvalidArgument("the list of authorized keys " + file.string() +
                           " can be written by group or others: chmod go-w it");
  }
  AllowedKeys allowed;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    const std::string where = file.string() + " line " + std::to_string(number) + ": ";
    std::istringstream words(line);
    std::string role;
    std::string key;
    std::string name;
    std::string rest;
    words >> role >> key >> name;
    if (role.empty()) continue;
    if (!RoleOfUser(role + ":").ok()) {
      return InvalidArgument(where + "role is '" + role + "', expected work, submit or admin");
    }
    if (!IsCurveKey(key)) return InvalidArgument(where + "expected a public key, 40 characters of Z85, after the role");
    if (words >> rest) return InvalidArgument(where + "unexpected '" + rest + "' after the name");
    if (name.empty()) name = key.substr(0, kDefaultNameCharacters);
    if (!allowed.emplace(key, role + ":" + name).second) return InvalidArgument(where + "the key is listed twice");
  }
  return allowed;
}

Result<CoordinatorKeys> ReadCoordinatorKeys(const std::filesystem::path& dir) {
  CoordinatorKeys keys;
  DEPTHFARM_ASSIGN_OR_RETURN(keys.own, ReadPair(dir, "coordinator"));
  DEPTHFARM_ASSIGN_OR_RETURN(keys.allowed, ReadAuthorized(dir / "authorized"));
  return keys;
}

Result<WorkerKeys> ReadWorkerKeys(const std::filesystem::path& dir) {
  WorkerKeys keys;
  DEPTHFARM_ASSIGN_OR_RETURN(keys.own, ReadPair(dir, "worker"));
  DEPTHFARM_ASSIGN_OR_RETURN(keys.coordinator_public_key, ReadPublicKey(dir / "coordinator.pub"));
  std::error_code error;
  if (std::filesystem::exists(dir / "authorized", error)) {
    DEPTHFARM_ASSIGN_OR_RETURN(keys.allowed_peers, ReadAuthorized(dir / "authorized"));
  } else {
    keys.allowed_peers.emplace(keys.own.public_key, "work:self");
  }
  return keys;
}

Result<ClientKeys> ReadClientKeys(const std::filesystem::path& dir) {
  ClientKeys keys;
  DEPTHFARM_ASSIGN_OR_RETURN(keys.own, ReadPair(dir, "client"));
  DEPTHFARM_ASSIGN_OR_RETURN(keys.coordinator_public_key, ReadPublicKey(dir / "coordinator.pub"));
  std::error_code error;
  if (!std::filesystem::exists(dir / "authorized", error)) return keys;
  DEPTHFARM_ASSIGN_OR_RETURN(const AllowedKeys all, ReadAuthorized(dir / "authorized"));
  for (const auto& [key, user] : all) {
    if (RoleOfUser(user).value() == Role::kWork) keys.workers.emplace(key, user);
  }
  return keys;
}

}  // namespace depthfarm
