#ifndef DEPTHFARM_COMMON_TEXT_CLEAN_LINE_H_
#define DEPTHFARM_COMMON_TEXT_CLEAN_LINE_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace depthfarm {

// `text` as one line of valid UTF-8, whatever wrote it: tabs become spaces, other control characters and bytes that are
// no UTF-8 become '?'. A line longer than `max_bytes` is cut between characters and ends with "...", within the bound.
[[nodiscard]] std::string CleanLine(std::string_view text, std::size_t max_bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TEXT_CLEAN_LINE_H_
