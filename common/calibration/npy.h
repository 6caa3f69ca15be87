#ifndef DEPTHFARM_COMMON_CALIBRATION_NPY_H_
#define DEPTHFARM_COMMON_CALIBRATION_NPY_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// A table of numbers, row by row.
struct NumberTable {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;  // rows x columns
  [[nodiscard]] double At(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

// A NumPy file (versions 1 to 3) of two dimensions, of 64-bit little-endian floats, in C or Fortran order; its header
// is a Python dictionary of the keys descr, fortran_order and shape, as numpy.save writes it. `file` is for messages.
// Errors  kInvalidArgument naming the file: it is none, another type or shape, or another number of bytes than the
//         shape takes. Takes memory in proportion to `bytes` alone.
[[nodiscard]] Result<NumberTable> ParseNpy(std::string_view bytes, const std::string& file);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_NPY_H_
