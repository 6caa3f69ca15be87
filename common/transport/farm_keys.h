#ifndef DEPTHFARM_COMMON_TRANSPORT_FARM_KEYS_H_
#define DEPTHFARM_COMMON_TRANSPORT_FARM_KEYS_H_

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/transport/keys.h"

namespace depthfarm {

// What a key may do on the farm. kAdmin may do what kSubmit may.
enum class Role { kWork, kSubmit, kAdmin };

// "work", "submit", "admin".
[[nodiscard]] std::string_view RoleName(Role role);

// Public key (Z85) -> user id "role:name", the form that ServerChannel reports with every message.
using AllowedKeys = std::map<std::string, std::string>;

// Role of a user id "role:name"; kInvalidArgument for anything else.
[[nodiscard]] Result<Role> RoleOfUser(std::string_view user_id);

// Makes DIR (0700, unless it is there already) with coordinator.key, coordinator.pub, worker.key, worker.pub,
// client.key, client.pub and authorized (worker: work, client: admin). kInvalidArgument if one of them exists.
[[nodiscard]] Status CreateFarmKeys(const std::filesystem::path& dir);

// Lines "<role> <public key> [name]"; empty lines and lines that begin with '#' count nothing. The name defaults to the
// first eight characters of the key. kInvalidArgument names file and line: unknown role, bad key, a key listed twice;
// or the file that group or others can write, since whoever writes it lets anybody in.
[[nodiscard]] Result<AllowedKeys> ReadAuthorized(const std::filesystem::path& file);

// What a coordinator needs of DIR: its pair and who may come.
struct CoordinatorKeys {
  CurveKeys own;
  AllowedKeys allowed;
};
[[nodiscard]] Result<CoordinatorKeys> ReadCoordinatorKeys(const std::filesystem::path& dir);

// What a worker needs of DIR: its pair, the coordinator's public key, and the keys that may fetch from it: all of
// DIR/authorized, since workers fetch inputs and submitters results; its own key alone where the file is missing.
struct WorkerKeys {
  CurveKeys own;
  std::string coordinator_public_key;
  AllowedKeys allowed_peers;
};
[[nodiscard]] Result<WorkerKeys> ReadWorkerKeys(const std::filesystem::path& dir);

// What a client needs of DIR, and if it serves files itself, the keys of the workers that may fetch them: those of role
// work in DIR/authorized; none where the file is missing.
struct ClientKeys {
  CurveKeys own;
  std::string coordinator_public_key;
  AllowedKeys workers;
};
[[nodiscard]] Result<ClientKeys> ReadClientKeys(const std::filesystem::path& dir);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_FARM_KEYS_H_
