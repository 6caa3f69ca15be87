#include "common/calibration/token_reader.h"

#include <charconv>
#include <cmath>

#include "common/sequence/json_fields.h"

namespace depthfarm {
namespace {

constexpr std::string_view kUtf8Mark = "\xef\xbb\xbf";

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }

}  // namespace

std::string Quoted(std::string_view word) { return Shortened(Json(std::string(word))); }

bool ParseFinite(std::string_view word, double* number) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, *number);
  return error == std::errc() && rest == end && std::isfinite(*number);
}

Result<TokenReader> TokenReader::Of(std::string_view text, std::string file) {
  if (text.starts_with(kUtf8Mark)) text.remove_prefix(kUtf8Mark.size());
  std::size_t line = 1;
  for (const char c : text) {
    if (c == '\n') ++line;
    const auto byte = static_cast<unsigned char>(c);  // char is signed on some machines
    if (IsSpace(c) || (byte >= ' ' && byte != 0x7f)) continue;
    return InvalidArgument(file + ": line " + std::to_string(line) + ": holds the byte " +
                           std::to_string(static_cast<int>(byte)) + ", which no text has: is it another format?");
  }
  TokenReader reader(text, std::move(file));
  if (reader.AtEnd()) return InvalidArgument(reader.file_ + ": is empty");
  return reader;
}

void TokenReader::SkipSpaces() {
  for (; at_ < text_.size() && IsSpace(text_[at_]); ++at_) {
    if (text_[at_] == '\n') ++line_;
  }
}

bool TokenReader::AtEnd() {
  SkipSpaces();
  return at_ == text_.size();
}

Result<std::string_view> TokenReader::Word(const std::string& what) {
  if (AtEnd()) return Bad("ends where " + what + " is expected");
  const std::size_t begin = at_;
  while (at_ < text_.size() && !IsSpace(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

Result<double> TokenReader::Number(const std::string& what) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string_view word, Word(what));
  double number = 0;
  if (!ParseFinite(word, &number)) return Bad(Quoted(word) + " stands where " + what + " is expected, a finite number");
  return number;
}

Result<std::uint64_t> TokenReader::Whole(const std::string& what, std::uint64_t max) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string_view word, Word(what));
  std::uint64_t number = 0;
  const char* end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, number);
  if (error != std::errc() || rest != end || number > max) {
    return Bad(Quoted(word) + " stands where " + what + " is expected, a whole number of 0 to " + std::to_string(max));
  }
  return number;
}

Result<Eigen::Vector3d> TokenReader::Vector3(const std::string& what) {
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) {
    DEPTHFARM_ASSIGN_OR_RETURN(vector[i], Number(what));
  }
  return vector;
}

Result<Eigen::Matrix3d> TokenReader::Matrix3(const std::string& what) {
  Eigen::Matrix3d matrix;
  for (int row = 0; row < 3; ++row) {
    DEPTHFARM_ASSIGN_OR_RETURN(const Eigen::Vector3d numbers, Vector3(what));
    matrix.row(row) = numbers.transpose();
  }
  return matrix;
}

Result<TokenReader::Matrix34> TokenReader::Matrix3x4(const std::string& what) {
  Matrix34 matrix;
  for (int row = 0; row < 3; ++row) {
    DEPTHFARM_ASSIGN_OR_RETURN(const Eigen::Vector3d numbers, Vector3(what));
    matrix.left.row(row) = numbers.transpose();
    DEPTHFARM_ASSIGN_OR_RETURN(matrix.right[row], Number(what));
  }
  return matrix;
}

std::string_view TokenReader::RestOfLine() {
  std::size_t end = text_.find('\n', at_);
  if (end == std::string_view::npos) end = text_.size();
  std::string_view rest = text_.substr(at_, end - at_);
  at_ = end;
  while (!rest.empty() && IsSpace(rest.front())) rest.remove_prefix(1);
  while (!rest.empty() && IsSpace(rest.back())) rest.remove_suffix(1);
  return rest;
}

void TokenReader::NextLine() {
  if (at_ == text_.size()) return;
  ++at_;
  ++line_;
}

bool TokenReader::LineGoesOn() {
  const std::size_t line = line_;
  return !AtEnd() && line_ == line;
}

void TokenReader::SkipComments() {
  while (!AtEnd() && text_[at_] == '#') (void)RestOfLine();
}

Status TokenReader::Bad(const std::string& what) const {
  return InvalidArgument(file_ + ": " + Position() + ": " + what);
}

}  // namespace depthfarm
