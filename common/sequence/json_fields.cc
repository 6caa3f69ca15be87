#include "common/sequence/json_fields.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace depthfarm {
namespace {

constexpr int kMaxNesting = 64;
constexpr std::size_t kMaxShown = 60;

// Thrown by the parser's callback, which has no other way to stop the parse; caught in ParseStrictJson.
struct Refused {
  std::string reason;
};

// Follows the parser through the objects and remembers the keys of those that are open.
class DuplicateKeyCheck {
 public:
  void Handle(int depth, Json::parse_event_t event, const Json& parsed) {
    if (depth > kMaxNesting) throw Refused{"nested deeper than " + std::to_string(kMaxNesting) + " levels"};
    switch (event) {
      case Json::parse_event_t::object_start:
      case Json::parse_event_t::array_start:
        CountInArray();
        open_.push_back({.is_array = event == Json::parse_event_t::array_start});
        break;
      case Json::parse_event_t::object_end:
      case Json::parse_event_t::array_end:
        open_.pop_back();
        break;
      case Json::parse_event_t::key: {
        const auto& key = parsed.get_ref<const std::string&>();
        if (!open_.back().keys.insert(key).second)
          throw Refused{Where() + "key " + Shortened(parsed) + " is given twice"};
        open_.back().key = key;
        break;
      }
      case Json::parse_event_t::value:
        CountInArray();
        break;
    }
  }

 private:
  struct Open {
    bool is_array = false;
    std::size_t entries = 0;  // of an array, so far
    std::set<std::string> keys = {};
    std::string key = {};  // of an object: the last
  };

  void CountInArray() {
    if (!open_.empty() && open_.back().is_array) ++open_.back().entries;
  }

  // "cameras[2].format: ", the innermost object that is open; nothing at the top.
  [[nodiscard]] std::string Where() const {
    std::string where;
    for (std::size_t i = 0; i + 1 < open_.size(); ++i) {
      if (open_[i].is_array) {
        where += "[" + std::to_string(open_[i].entries - 1) + "]";
      } else {
        where += (where.empty() ? "" : ".") + open_[i].key;
      }
    }
    return where.empty() ? "" : where + ": ";
  }

  std::vector<Open> open_;
};

// nlohmann's messages begin with "[json.exception.parse_error.101] ", which says nothing to a user.
std::string WithoutTag(const std::string& message) {
  const std::size_t end = message.find("] ");
  return !message.empty() && message.front() == '[' && end != std::string::npos ? message.substr(end + 2) : message;
}

bool ReadVector(const Json& value, Eigen::Vector3d* result) {
  if (!value.is_array() || value.size() != 3) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!value[i].is_number()) return false;
    (*result)[static_cast<Eigen::Index>(i)] = value[i].get<double>();
  }
  return std::isfinite((*result)[0]) && std::isfinite((*result)[1]) && std::isfinite((*result)[2]);
}

}  // namespace

std::string Shortened(const Json& value) {
  std::string text = value.dump(-1, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace);
  if (text.size() > kMaxShown) text = text.substr(0, kMaxShown) + "...";
  return text;
}

bool HasControlCharacter(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);  // char is signed on some machines
    return byte < ' ' || byte == 0x7f;
  });
}

Result<Json> ParseStrictJson(std::string_view text) {
  if (text.empty()) return InvalidArgument("is empty, expected JSON");
  DuplicateKeyCheck check;
  const auto callback = [&check](int depth, Json::parse_event_t event, Json& parsed) {
    check.Handle(depth, event, parsed);
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), callback);
  } catch (const Refused& refused) {
    return InvalidArgument(refused.reason);
  } catch (const Json::exception& error) {
    return InvalidArgument("is not valid JSON: " + WithoutTag(error.what()));
  } catch (const std::bad_alloc&) {
    return Unavailable("no memory to parse " + std::to_string(text.size()) + " bytes of JSON");
  }
}

Result<JsonFields> JsonFields::Of(const Json& value, std::string where, std::span<const std::string_view> keys) {
  DEPTHFARM_ASSIGN_OR_RETURN(JsonFields fields, OfForeign(value, where));
  for (const auto& [key, unused] : value.items()) {
    if (key.starts_with("x-") || std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    std::string known;
    for (const std::string_view name : keys) known += (known.empty() ? "" : ", ") + std::string(name);
    return InvalidArgument(where + ": unknown key " + Shortened(Json(key)) + ", expected one of " + known +
                           ", or a key that begins with x-");
  }
  return fields;
}

Result<JsonFields> JsonFields::OfForeign(const Json& value, std::string where) {
  if (!value.is_object()) return InvalidArgument(where + ": is " + Shortened(value) + ", expected an object {...}");
  return JsonFields(value, std::move(where));
}

Status JsonFields::WrongValue(std::string_view key, const Json& value, const std::string& expected) const {
  return Bad("'" + std::string(key) + "' is " + Shortened(value) + ", expected " + expected);
}

Result<const Json*> JsonFields::Value(std::string_view key) const {
  const auto found = object_->find(key);
  if (found == object_->end()) return Bad("key '" + std::string(key) + "' is missing");
  return &*found;
}

Result<std::string> JsonFields::String(std::string_view key) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, Value(key));
  if (!value->is_string()) return WrongValue(key, *value, "a text");
  return value->get<std::string>();
}

Result<double> JsonFields::Number(std::string_view key) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, Value(key));
  if (!value->is_number() || !std::isfinite(value->get<double>())) return WrongValue(key, *value, "a finite number");
  return value->get<double>();
}

Result<double> JsonFields::Positive(std::string_view key) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const double number, Number(key));
  if (!(number > 0)) return WrongValue(key, *object_->find(key), "a number > 0");
  return number;
}

Result<std::int64_t> JsonFields::Integer(std::string_view key, std::int64_t min, std::int64_t max) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, Value(key));
  // Within double's exact integers, so that the comparison below is exact for 1e99 and 640.5 alike.
  const double number = value->is_number() ? value->get<double>() : 0;
  if (!value->is_number() || number != std::floor(number) || number < static_cast<double>(min) ||
      number > static_cast<double>(max)) {
    return WrongValue(key, *value, "a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  }
  return static_cast<std::int64_t>(number);
}

Result<const Json*> JsonFields::Array(std::string_view key, std::size_t max_size) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, Value(key));
  if (!value->is_array()) return WrongValue(key, *value, "a list [...]");
  if (value->size() > max_size) {
    return Bad("'" + std::string(key) + "' has " + std::to_string(value->size()) + " entries, expected at most " +
               std::to_string(max_size));
  }
  return value;
}

Result<std::vector<std::string>> JsonFields::Strings(std::string_view key, std::size_t max_size) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, Array(key, max_size));
  std::vector<std::string> result;
  result.reserve(value->size());
  for (const Json& entry : *value) {
    if (!entry.is_string()) {
      return WrongValue(std::string(key) + "[" + std::to_string(result.size()) + "]", entry, "a text");
    }
    result.push_back(entry.get<std::string>());
  }
  return result;
}

Result<Eigen::Vector3d> JsonFields::Vector3(std::string_view key) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, Value(key));
  Eigen::Vector3d result;
  if (!ReadVector(*value, &result)) return WrongValue(key, *value, "a list of 3 finite numbers");
  return result;
}

Result<Eigen::Matrix3d> JsonFields::Matrix3(std::string_view key) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, Value(key));
  Eigen::Matrix3d result;
  bool good = value->is_array() && value->size() == 3;
  for (int row = 0; good && row < 3; ++row) {
    Eigen::Vector3d numbers;
    good = ReadVector((*value)[static_cast<std::size_t>(row)], &numbers);
    if (good) result.row(row) = numbers.transpose();
  }
  if (!good) return WrongValue(key, *value, "3 rows of 3 finite numbers");
  return result;
}

}  // namespace depthfarm
