#include "common/calibration/byte_reader.h"

#include <bit>
#include <cmath>

#include "common/base/little_endian.h"

namespace depthfarm {

Status ByteReader::Bad(const std::string& what) const {
  return InvalidArgument(file_ + ": " + Position() + ": " + what);
}

Status ByteReader::Skip(std::uint64_t bytes, const std::string& what) {
  if (bytes > left()) return Bad("ends amid " + what + ": is the file whole?");
  at_ += bytes;
  return {};
}

Result<std::uint32_t> ByteReader::U32(const std::string& what) {
  const std::size_t begin = at_;
  DEPTHFARM_RETURN_IF_ERROR(Skip(sizeof(std::uint32_t), what));
  return ReadU32(bytes_, begin);
}

Result<std::uint64_t> ByteReader::U64(const std::string& what) {
  const std::size_t begin = at_;
  DEPTHFARM_RETURN_IF_ERROR(Skip(sizeof(std::uint64_t), what));
  return ReadU64(bytes_, begin);
}

Result<double> ByteReader::Float64(const std::string& what) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t bits, U64(what));
  const auto number = std::bit_cast<double>(bits);
  if (!std::isfinite(number)) return Bad(what + " has a number that is not finite");
  return number;
}

Result<Eigen::Vector3d> ByteReader::Vector3(const std::string& what) {
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) {
    DEPTHFARM_ASSIGN_OR_RETURN(vector[i], Float64(what));
  }
  return vector;
}

Result<std::string_view> ByteReader::ZeroTerminated(const std::string& what) {
  const std::size_t end = bytes_.find('\0', at_);
  if (end == std::string_view::npos) return Bad("ends amid " + what + ": is the file whole?");
  const std::string_view text = bytes_.substr(at_, end - at_);
  at_ = end + 1;
  return text;
}

Result<std::uint64_t> ByteReader::Count(const std::string& what, std::size_t entry_bytes) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t count, U64("the number of " + what));
  if (count > left() / entry_bytes) {
    return Bad("claims " + std::to_string(count) + " " + what + ", the " + std::to_string(left()) +
               " bytes that follow hold at most " + std::to_string(left() / entry_bytes) + ": is the file whole?");
  }
  return count;
}

Status ByteReader::ExpectEnd() const {
  return left() == 0 ? Status() : Bad("goes on where it should end, for " + std::to_string(left()) + " bytes");
}

}  // namespace depthfarm
