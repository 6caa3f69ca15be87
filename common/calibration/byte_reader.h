#ifndef DEPTHFARM_COMMON_CALIBRATION_BYTE_READER_H_
#define DEPTHFARM_COMMON_CALIBRATION_BYTE_READER_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// Little-endian numbers of a file, one after the other. Messages begin "<file>: byte <n>: ". Holds a reference: the
// bytes must outlive it.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] std::string Position() const { return "byte " + std::to_string(at_); }

  // kInvalidArgument "ends amid <what>". Numbers of Float64 and Vector3 are finite.
  [[nodiscard]] Result<std::uint32_t> U32(const std::string& what);
  [[nodiscard]] Result<std::uint64_t> U64(const std::string& what);
  [[nodiscard]] Result<double> Float64(const std::string& what);
  [[nodiscard]] Result<Eigen::Vector3d> Vector3(const std::string& what);
  // Up to the next zero, which is passed over.
  [[nodiscard]] Result<std::string_view> ZeroTerminated(const std::string& what);
  // A number of entries of at least `entry_bytes` each, which the rest of the file can hold: what is allocated for them
  // is no more than a multiple of the file.
  [[nodiscard]] Result<std::uint64_t> Count(const std::string& what, std::size_t entry_bytes);
  [[nodiscard]] Status Skip(std::uint64_t bytes, const std::string& what);

  // Fails unless all was read.
  [[nodiscard]] Status ExpectEnd() const;
  // kInvalidArgument "<file>: byte <n>: <what>".
  [[nodiscard]] Status Bad(const std::string& what) const;

 private:
  std::string_view bytes_;
  std::string file_;
  std::size_t at_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_BYTE_READER_H_
