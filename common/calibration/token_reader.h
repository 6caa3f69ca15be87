#ifndef DEPTHFARM_COMMON_CALIBRATION_TOKEN_READER_H_
#define DEPTHFARM_COMMON_CALIBRATION_TOKEN_READER_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// The words of a text file between spaces and ends of lines (any: LF, CR LF), with the lines they are on. A mark of
// UTF-8 at the beginning is passed over. Messages begin "<file>: line <n>: ". Holds a reference: the text must outlive
// it.
class TokenReader {
 public:
  // kInvalidArgument: the text is empty or holds control characters, so is no text of this kind.
  [[nodiscard]] static Result<TokenReader> Of(std::string_view text, std::string file);

  [[nodiscard]] const std::string& file() const { return file_; }
  // Whether no word is left.
  [[nodiscard]] bool AtEnd();
  // "line 12": of the last word, after AtEnd of the next one; from 1.
  [[nodiscard]] std::string Position() const { return "line " + std::to_string(line_); }

  // The next word. kInvalidArgument at the end: "ends where <what> is expected".
  [[nodiscard]] Result<std::string_view> Word(const std::string& what);
  // The same as a finite number, or a whole one of 0 to `max`.
  [[nodiscard]] Result<double> Number(const std::string& what);
  [[nodiscard]] Result<std::uint64_t> Whole(const std::string& what, std::uint64_t max);
  // `count` numbers, row by row.
  [[nodiscard]] Result<Eigen::Matrix3d> Matrix3(const std::string& what);
  [[nodiscard]] Result<Eigen::Vector3d> Vector3(const std::string& what);
  // Three rows of [M | v].
  struct Matrix34 {
    Eigen::Matrix3d left;
    Eigen::Vector3d right;
  };
  [[nodiscard]] Result<Matrix34> Matrix3x4(const std::string& what);

  // The rest of the line without spaces at its ends; may be empty.
  [[nodiscard]] std::string_view RestOfLine();
  // Passes over the end of the line, after RestOfLine.
  void NextLine();
  // Whether the next word is on the line of the last one.
  [[nodiscard]] bool LineGoesOn();
  // Passes over lines that are empty or begin with '#'.
  void SkipComments();

  // kInvalidArgument "<file>: line <n>: <what>".
  [[nodiscard]] Status Bad(const std::string& what) const;

 private:
  TokenReader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}
  void SkipSpaces();

  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

// Text of a file, e.g. a word where a number is expected, as it may appear in a message.
[[nodiscard]] std::string Quoted(std::string_view word);

// The whole of `word` as a finite number; false when it is none. A '+' may stand before it.
[[nodiscard]] bool ParseFinite(std::string_view word, double* number);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_TOKEN_READER_H_
