#include "coordinator/importing/picture_pattern.h"

#include <algorithm>

namespace depthfarm {
namespace {

std::string WithDigits(std::string number, std::size_t digits) {
  if (number.size() < digits) number.insert(0, digits - number.size(), '0');
  return number;
}

// The digits at the end of `name`, without zeros before them; "" where there are none.
std::string NumberAtEnd(const std::string& name) {
  const std::size_t before = name.find_last_not_of("0123456789");
  const std::string digits = before == std::string::npos ? name : name.substr(before + 1);
  const std::size_t first = digits.find_first_not_of('0');
  if (first != std::string::npos) return digits.substr(first);
  return digits.empty() ? "" : "0";
}

}  // namespace

bool PicturePattern::ParseField(const std::string& field, Part& part) {
  const std::size_t colon = field.find(':');
  const std::string name = field.substr(0, colon);
  if (name == "camera" && colon == std::string::npos) {
    part.kind = Part::Kind::kCamera;
    return true;
  }
  if (name == "number") {
    part.kind = Part::Kind::kNumber;
  } else if (name == "frame") {
    part.kind = Part::Kind::kFrame;
  } else {
    return false;
  }
  if (colon == std::string::npos) return true;
  const std::string digits = field.substr(colon + 1);
  if (digits.size() != 2 || digits[0] != '0' || digits[1] < '1' || digits[1] > '9') return false;
  part.digits = static_cast<std::size_t>(digits[1] - '0');
  return true;
}

Result<PicturePattern> PicturePattern::Parse(const std::string& text) {
  const auto bad = [&](const std::string& what) { return InvalidArgument("--images is '" + text + "': " + what); };
  PicturePattern pattern;
  pattern.text_ = text;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = std::min(text.find('{', at), text.size());
    if (open > at) {
      pattern.parts_.push_back({.kind = Part::Kind::kText, .text = text.substr(at, open - at)});
    }
    if (open == text.size()) break;
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos) return bad("a '{' is not closed");
    const std::string field = text.substr(open + 1, close - open - 1);
    Part part;
    if (!ParseField(field, part)) {
      return bad("there is no {" + field + "}; there are {camera}, {number}, {frame}, {number:02}, {frame:04}");
    }
    pattern.parts_.push_back(std::move(part));
    at = close + 1;
  }
  return pattern;
}

bool PicturePattern::Has(Part::Kind kind) const {
  return std::ranges::any_of(parts_, [kind](const Part& part) { return part.kind == kind; });
}

Result<std::string> PicturePattern::PathOf(const std::string& camera, int frame) const {
  std::string path;
  for (const Part& part : parts_) {
    switch (part.kind) {
      case Part::Kind::kText:
        path += part.text;
        break;
      case Part::Kind::kCamera:
        path += camera;
        break;
      case Part::Kind::kNumber: {
        const std::string number = NumberAtEnd(camera);
        if (number.empty()) {
          return InvalidArgument("camera '" + camera + "': its name ends in no number, which --images '" + text_ +
                                 "' asks for: use {camera}");
        }
        path += WithDigits(number, part.digits);
        break;
      }
      case Part::Kind::kFrame:
        path += WithDigits(std::to_string(frame), part.digits);
        break;
    }
  }
  return path;
}

}  // namespace depthfarm
