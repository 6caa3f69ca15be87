#ifndef DEPTHFARM_COMMON_DIGEST_SHA256_H_
#define DEPTHFARM_COMMON_DIGEST_SHA256_H_

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace depthfarm {

using Sha256Digest = std::array<std::uint8_t, 32>;

// SHA-256 (FIPS 180-4) of bytes that come in pieces. Only running out of memory can make it fail, which aborts.
class Sha256Hasher {
 public:
  Sha256Hasher();
  ~Sha256Hasher();
  Sha256Hasher(Sha256Hasher&&) noexcept;
  Sha256Hasher& operator=(Sha256Hasher&&) noexcept;

  void Update(std::string_view bytes);
  void Update(std::span<const std::uint8_t> bytes);
  // Ends the hash and begins a new one.
  [[nodiscard]] Sha256Digest Finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

[[nodiscard]] Sha256Digest Sha256(std::string_view bytes);

// Lower-case hexadecimal, two digits a byte.
[[nodiscard]] std::string Hex(std::span<const std::uint8_t> bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_DIGEST_SHA256_H_
