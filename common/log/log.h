#ifndef DEPTHFARM_COMMON_LOG_LOG_H_
#define DEPTHFARM_COMMON_LOG_LOG_H_

#include <concepts>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// One key=value of a log line.
struct LogField {
  LogField(std::string_view name, std::string_view text) : key(name), value(text) {}
  LogField(std::string_view name, const char* text) : key(name), value(text) {}
  LogField(std::string_view name, const std::string& text) : key(name), value(text) {}
  LogField(std::string_view name, bool flag) : key(name), value(flag ? "true" : "false") {}
  LogField(std::string_view name, std::integral auto number) : key(name), value(std::to_string(number)) {}
  LogField(std::string_view name, double number);

  std::string_view key;
  std::string value;
};

// Lines go to stderr: time, level, event, fields: "2026-01-02T03:04:05.678Z info task_granted job=12 lease=991".
// Thread-safe. For services and programs only: pure folders return values instead.
enum class LogLevel { kDebug, kInfo, kWarning, kError };
void Log(LogLevel level, std::string_view event, std::span<const LogField> fields);
void LogDebug(std::string_view event, std::initializer_list<LogField> fields = {});
void LogInfo(std::string_view event, std::initializer_list<LogField> fields = {});
void LogWarning(std::string_view event, std::initializer_list<LogField> fields = {});
void LogError(std::string_view event, std::initializer_list<LogField> fields = {});

// debug, info (the default), warning, error or off; kInvalidArgument lists them.
[[nodiscard]] Status SetLogLevel(std::string_view level);

// The part of a line after time and level. Values that are empty or hold a space, '"', '=' or a control character are
// quoted, with \", \\, \n, \t and \xNN escapes, so that a line is one line whatever a peer sent.
[[nodiscard]] std::string FormatLogLine(std::string_view event, std::span<const LogField> fields);

// Whether that is a whole line of Log, of this process or another one, at level debug or info.
[[nodiscard]] bool IsRoutineLine(std::string_view line);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_LOG_LOG_H_
