#ifndef DEPTHFARM_COORDINATOR_CLI_TEXT_TABLE_H_
#define DEPTHFARM_COORDINATOR_CLI_TEXT_TABLE_H_

#include <string>
#include <vector>

namespace depthfarm {

// Columns as wide as their widest cell, two spaces apart; columns flagged in `right` are flush right. One line per row,
// each with at most as many cells as `right` has flags.
[[nodiscard]] std::string FormatTable(const std::vector<std::vector<std::string>>& rows,
                                      const std::vector<bool>& right);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_TEXT_TABLE_H_
