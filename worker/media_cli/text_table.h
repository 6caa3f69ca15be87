#ifndef DEPTHFARM_WORKER_MEDIA_CLI_TEXT_TABLE_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_TEXT_TABLE_H_

#include <iosfwd>
#include <string>
#include <vector>

namespace depthfarm {

// Rows of text in aligned columns: the first `left_columns` to the left, the others, numbers, to the right.
class TextTable {
 public:
  TextTable(std::vector<std::string> header, std::size_t left_columns)
      : left_columns_(left_columns), rows_({std::move(header)}) {}

  void Add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  // Each line indented by two spaces, columns two apart, no trailing spaces.
  void Print(std::ostream& out) const;

 private:
  std::size_t left_columns_;
  std::vector<std::vector<std::string>> rows_;
};

// `value` with `decimals` digits after the point; "-" for NaN, "inf" for infinity.
[[nodiscard]] std::string Decimal(double value, int decimals);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_TEXT_TABLE_H_
