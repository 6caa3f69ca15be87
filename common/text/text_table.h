#ifndef DEPTHFARM_COMMON_TEXT_TEXT_TABLE_H_
#define DEPTHFARM_COMMON_TEXT_TEXT_TABLE_H_

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace depthfarm {

// Columns as wide as their widest cell, two spaces apart; columns flagged in `right` are flush right. One line per row,
// each after `indent` spaces and without spaces at its end; a row has at most as many cells as `right` has flags.
[[nodiscard]] std::string FormatTable(const std::vector<std::vector<std::string>>& rows, const std::vector<bool>& right,
                                      std::size_t indent = 0);

// Rows that are added one by one: the first `left_columns` flush left, the others, numbers, flush right.
class TextTable {
 public:
  TextTable(std::vector<std::string> header, std::size_t left_columns)
      : left_columns_(left_columns), rows_({std::move(header)}) {}

  // At most as many cells as the header.
  void Add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  // Indented by two spaces.
  void Print(std::ostream& out) const;

 private:
  std::size_t left_columns_;
  std::vector<std::vector<std::string>> rows_;
};

// `value` with `decimals` digits after the point; "-" for NaN, "inf" for infinity.
[[nodiscard]] std::string Decimal(double value, int decimals);

// Digits in groups of three: "1,234,567".
[[nodiscard]] std::string WithThousands(std::uint64_t number);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TEXT_TEXT_TABLE_H_
