#ifndef DEPTHFARM_COMMON_TEXT_UTC_TIME_H_
#define DEPTHFARM_COMMON_TEXT_UTC_TIME_H_

#include <chrono>
#include <string>

namespace depthfarm {

// ISO 8601 to the second: "2024-05-17T08:30:00Z".
[[nodiscard]] std::string FormatUtc(std::chrono::system_clock::time_point time);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TEXT_UTC_TIME_H_
