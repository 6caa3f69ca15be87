#include "common/files/path_map.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

// One spelling of a folder: no "//", ".", or "/" at the end.
Result<fs::path> FolderOf(const std::string& rule, const std::string& text) {
  const fs::path path(text);
  if (!path.is_absolute() || std::ranges::find(path, fs::path("..")) != path.end()) {
    return InvalidArgument("path map '" + rule + "': '" + text +
                           "' is not an absolute path without '..', expected FROM=TO, e.g. /shared=/mnt/shared");
  }
  const fs::path normal = path.lexically_normal();
  return normal.has_filename() || normal == normal.root_path() ? normal : normal.parent_path();
}

auto Components(const fs::path& path) { return std::distance(path.begin(), path.end()); }

// Whether a text names the folder or something in it.
bool Names(std::string_view text, const std::string& folder) {
  for (std::size_t at = text.find(folder); at != std::string_view::npos; at = text.find(folder, at + 1)) {
    const std::size_t end = at + folder.size();
    const bool begins = at == 0 || text[at - 1] == ' ' || text[at - 1] == '\'';
    const bool ends =
        folder == "/" || end == text.size() || std::string_view("/:', ;").find(text[end]) != std::string_view::npos;
    if (begins && ends) return true;
  }
  return false;
}

}  // namespace

Result<PathMap> PathMap::Parse(const std::vector<std::string>& rules) {
  PathMap map;
  for (const std::string& rule : rules) {
    const std::size_t equals = rule.find("=/");
    if (equals == std::string::npos)
      return InvalidArgument("path map '" + rule + "': expected FROM=TO, two absolute paths");
    DEPTHFARM_ASSIGN_OR_RETURN(fs::path from, FolderOf(rule, rule.substr(0, equals)));
    DEPTHFARM_ASSIGN_OR_RETURN(fs::path to, FolderOf(rule, rule.substr(equals + 1)));
    if (std::ranges::any_of(map.rules_, [&](const Rule& other) { return other.from == from; }))
      return InvalidArgument("path map '" + rule + "': " + from.string() + " is mapped twice");
    map.rules_.push_back({std::move(from), std::move(to)});
  }
  std::ranges::stable_sort(map.rules_, std::ranges::greater(), [](const Rule& rule) { return Components(rule.from); });
  return map;
}

std::string PathMap::Map(const std::string& path) const {
  if (path.empty()) return path;
  const fs::path normal = fs::path(path).lexically_normal();
  for (const Rule& rule : rules_) {
    const auto [end_of_from, rest] = std::ranges::mismatch(rule.from, normal);
    if (end_of_from != rule.from.end()) continue;
    fs::path mapped = rule.to;
    for (auto part = rest; part != normal.end(); ++part) mapped /= *part;
    return mapped.string();
  }
  return path;
}

Status PathMap::Explain(const Status& failure) const {
  if (failure.ok()) return failure;
  std::string text = failure.message();
  for (const Rule& rule : rules_) {
    if (rule.to != rule.from && Names(failure.message(), rule.to.string()))
      text += " (" + rule.to.string() + " is " + rule.from.string() + " of the job: --path-map)";
  }
  return {failure.code(), std::move(text)};
}

}  // namespace depthfarm
