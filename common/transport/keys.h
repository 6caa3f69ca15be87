#ifndef DEPTHFARM_COMMON_TRANSPORT_KEYS_H_
#define DEPTHFARM_COMMON_TRANSPORT_KEYS_H_

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// A CURVE key pair; both halves as 40 characters of Z85.
struct CurveKeys {
  std::string public_key;
  std::string secret_key;
};

[[nodiscard]] Result<CurveKeys> GenerateCurveKeys();

// True for 40 characters that decode to a 32-byte key.
[[nodiscard]] bool IsCurveKey(std::string_view text);

// A file that holds one key and a newline. Writing never replaces a file (kInvalidArgument: exists). Secret keys have
// mode 0600; reading refuses (kInvalidArgument) one that group or others can read or write, that belongs to somebody
// else, or that is not a regular file.
[[nodiscard]] Status WriteSecretKey(const std::filesystem::path& file, const std::string& key);
[[nodiscard]] Status WritePublicKey(const std::filesystem::path& file, const std::string& key);
// The same of any text that everybody may read and its owner alone write.
[[nodiscard]] Status WritePublicText(const std::filesystem::path& file, const std::string& text);
[[nodiscard]] Result<std::string> ReadSecretKey(const std::filesystem::path& file);
[[nodiscard]] Result<std::string> ReadPublicKey(const std::filesystem::path& file);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_KEYS_H_
