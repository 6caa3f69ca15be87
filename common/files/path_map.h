#ifndef DEPTHFARM_COMMON_FILES_PATH_MAP_H_
#define DEPTHFARM_COMMON_FILES_PATH_MAP_H_

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// Where this host has the folders that jobs name: rules FROM -> TO of absolute paths. Touches no file.
class PathMap {
 public:
  PathMap() = default;  // every path stays as it is
  // Rules as the command line has them, "FROM=TO", split at the first "=/". Errors (kInvalidArgument, naming the rule):
  // a part is not absolute or has "..", or a FROM is there twice.
  [[nodiscard]] static Result<PathMap> Parse(const std::vector<std::string>& rules);

  // The path as this host opens it: that of the rule with the longest FROM of which the path has all components at its
  // beginning ("/a" is no beginning of "/ab"); the path itself where there is none. What is empty stays empty.
  [[nodiscard]] std::string Map(const std::string& path) const;
  // A failure whose message names what this host opened says as well what the job calls it.
  [[nodiscard]] Status Explain(const Status& failure) const;

 private:
  struct Rule {
    std::filesystem::path from;
    std::filesystem::path to;
  };
  std::vector<Rule> rules_;  // those with more components in FROM first
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_FILES_PATH_MAP_H_
