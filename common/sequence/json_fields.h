#ifndef DEPTHFARM_COMMON_SEQUENCE_JSON_FIELDS_H_
#define DEPTHFARM_COMMON_SEQUENCE_JSON_FIELDS_H_

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

using Json = nlohmann::json;

// Parses JSON text. Beyond RFC 8259, a key given twice in one object and nesting past 64 levels are errors: the reader
// would keep one of two values without a word. Comments, NaN, numbers past the range of a double and text that is not
// UTF-8 are refused by the grammar. Errors (kInvalidArgument) give line and column, or the key.
[[nodiscard]] Result<Json> ParseStrictJson(std::string_view text);

// One object of a JSON file, read field by field. `where` begins every message, e.g. "array.json: camera 'cam3'".
// A field that is missing, of another type or out of bounds is kInvalidArgument naming where, key, value and
// expectation. Holds a reference: the document must outlive it.
class JsonFields {
 public:
  // Fails unless `value` is an object whose keys are all among `keys` or begin with "x-".
  [[nodiscard]] static Result<JsonFields> Of(const Json& value, std::string where,
                                             std::span<const std::string_view> keys);
  // Of another program's file, which may have keys that are unknown here. Fails unless `value` is an object.
  [[nodiscard]] static Result<JsonFields> OfForeign(const Json& value, std::string where);

  [[nodiscard]] const std::string& where() const { return where_; }
  void set_where(std::string where) { where_ = std::move(where); }
  [[nodiscard]] bool Has(std::string_view key) const { return object_->contains(key); }
  // The raw value; kInvalidArgument when missing.
  [[nodiscard]] Result<const Json*> Value(std::string_view key) const;

  [[nodiscard]] Result<std::string> String(std::string_view key) const;
  [[nodiscard]] Result<double> Number(std::string_view key) const;  // finite
  [[nodiscard]] Result<double> Positive(std::string_view key) const;
  [[nodiscard]] Result<std::int64_t> Integer(std::string_view key, std::int64_t min, std::int64_t max) const;
  [[nodiscard]] Result<const Json*> Array(std::string_view key, std::size_t max_size) const;
  [[nodiscard]] Result<std::vector<std::string>> Strings(std::string_view key, std::size_t max_size) const;
  [[nodiscard]] Result<Eigen::Vector3d> Vector3(std::string_view key) const;
  [[nodiscard]] Result<Eigen::Matrix3d> Matrix3(std::string_view key) const;  // a list of 3 rows

  // kInvalidArgument "where: what".
  [[nodiscard]] Status Bad(const std::string& what) const { return InvalidArgument(where_ + ": " + what); }

 private:
  JsonFields(const Json& object, std::string where) : object_(&object), where_(std::move(where)) {}
  [[nodiscard]] Status WrongValue(std::string_view key, const Json& value, const std::string& expected) const;

  const Json* object_;
  std::string where_;
};

// The value as it may appear in a message: its JSON text, shortened, invalid characters replaced.
[[nodiscard]] std::string Shortened(const Json& value);

// Whether the text holds a control character (below space, or DEL).
[[nodiscard]] bool HasControlCharacter(std::string_view text);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_JSON_FIELDS_H_
