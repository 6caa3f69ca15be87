#include "common/transport/keys.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>

namespace depthfarm {
namespace {

constexpr std::size_t kKeyCharacters = 40;
constexpr mode_t kSecretMode = 0600;
constexpr mode_t kPublicMode = 0644;

std::string ErrnoText() { return std::strerror(errno); }

Status WriteNew(const std::filesystem::path& file, const std::string& text, mode_t mode) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, mode);
  if (fd < 0) {
    if (errno == EEXIST) return InvalidArgument(file.string() + " exists already: keys are never replaced");
    return Unavailable("cannot write " + file.string() + ": " + ErrnoText());
  }
  const bool written = ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(fd) == 0;
  const std::string reason = ErrnoText();
  ::close(fd);
  if (!written) return Unavailable("cannot write " + file.string() + ": " + reason);
  return {};
}

Result<std::string> KeyOf(const std::filesystem::path& file, std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  if (!IsCurveKey(text)) return InvalidArgument(file.string() + " is not a key file: expected 40 characters of Z85");
  return text;
}

}  // namespace

Result<CurveKeys> GenerateCurveKeys() {
  std::array<char, kKeyCharacters + 1> public_key{};
  std::array<char, kKeyCharacters + 1> secret_key{};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    return Internal(std::string("cannot generate CURVE keys: ") + zmq_strerror(zmq_errno()));
  }
  return CurveKeys{public_key.data(), secret_key.data()};
}

bool IsCurveKey(std::string_view text) {
  if (text.size() != kKeyCharacters || text.find('\0') != std::string_view::npos) return false;
  std::array<std::uint8_t, 32> bytes{};
  return zmq_z85_decode(bytes.data(), std::string(text).c_str()) != nullptr;
}

Status WriteSecretKey(const std::filesystem::path& file, const std::string& key) {
  return WriteNew(file, key + "\n", kSecretMode);
}

Status WritePublicKey(const std::filesystem::path& file, const std::string& key) {
  return WriteNew(file, key + "\n", kPublicMode);
}

Status WritePublicText(const std::filesystem::path& file, const std::string& text) {
  return WriteNew(file, text, kPublicMode);
}

Result<std::string> ReadSecretKey(const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return InvalidArgument("cannot read key " + file.string() + ": " + ErrnoText());
  struct stat info {};
  std::array<char, 4 * kKeyCharacters> text{};
  const bool known = ::fstat(fd, &info) == 0;
  const ssize_t length = known && S_ISREG(info.st_mode) ? ::read(fd, text.data(), text.size()) : -1;
  ::close(fd);
  if (!known || !S_ISREG(info.st_mode) || length < 0) {
    return InvalidArgument("cannot read key " + file.string() + ": not a readable regular file");
  }
  if ((info.st_mode & 077) != 0) {
    return InvalidArgument("secret key " + file.string() + " is open to group or others: chmod 600 it");
  }
  if (info.st_uid != ::geteuid() && info.st_uid != 0) {
    return InvalidArgument("secret key " + file.string() + " belongs to user " + std::to_string(info.st_uid) +
                           ", expected " + std::to_string(::geteuid()));
  }
  return KeyOf(file, std::string(text.data(), static_cast<std::size_t>(length)));
}

Result<std::string> ReadPublicKey(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!stream) return InvalidArgument("cannot read key " + file.string() + ": " + ErrnoText());
  std::getline(stream, line);  // an empty file is no key file
  return KeyOf(file, line);
}

}  // namespace depthfarm
