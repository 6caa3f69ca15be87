#include "common/log/log.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <utility>

#include "common/log/log_collector.h"

namespace depthfarm {
namespace {

spdlog::logger& Logger() {
  static const std::shared_ptr<spdlog::logger> logger = [] {
    auto made = std::make_shared<spdlog::logger>("depthfarm", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    made->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
    made->set_level(spdlog::level::info);
    return made;
  }();
  return *logger;
}

bool NeedsQuotes(std::string_view value) {
  return value.empty() || std::any_of(value.begin(), value.end(), [](char c) {
           const auto byte = static_cast<unsigned char>(c);
           return byte <= 0x20 || byte == 0x7f || c == '"' || c == '=' || c == '\\';
         });
}

void AppendQuoted(std::string& line, std::string_view value) {
  line += '"';
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      line += '\\';
      line += c;
    } else if (c == '\n') {
      line += "\\n";
    } else if (c == '\t') {
      line += "\\t";
    } else if (byte < 0x20 || byte == 0x7f) {
      std::array<char, 8> code{};
      std::snprintf(code.data(), code.size(), "\\x%02x", byte);
      line += code.data();
    } else {
      line += c;
    }
  }
  line += '"';
}

spdlog::level::level_enum LibraryLevel(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

}  // namespace

LogField::LogField(std::string_view name, double number) : key(name) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.6g", number);
  value = text.data();
}

std::string FormatLogLine(std::string_view event, std::span<const LogField> fields) {
  std::string line(event);
  for (const LogField& field : fields) {
    line += ' ';
    line += field.key;
    line += '=';
    if (NeedsQuotes(field.value)) {
      AppendQuoted(line, field.value);
    } else {
      line += field.value;
    }
  }
  return line;
}

bool IsRoutineLine(std::string_view line) {
  constexpr std::string_view kTime = "0000-00-00T00:00:00.000Z ";  // a digit for each 0
  if (line.size() < kTime.size()) return false;
  const auto fits = [](char form, char c) { return form == '0' ? c >= '0' && c <= '9' : c == form; };
  if (!std::equal(kTime.begin(), kTime.end(), line.begin(), fits)) return false;
  line.remove_prefix(kTime.size());
  return line.starts_with("info ") || line.starts_with("debug ");
}

void Log(LogLevel level, std::string_view event, std::span<const LogField> fields) {
  LogCollector* collector = level < LogLevel::kWarning ? nullptr : LogCollector::OfThread();
  if (collector != nullptr)
    collector->Add((level == LogLevel::kError ? "error " : "warning ") + FormatLogLine(event, fields));
  if (!Logger().should_log(LibraryLevel(level))) return;
  Logger().log(LibraryLevel(level), FormatLogLine(event, fields));
}

void LogDebug(std::string_view event, std::initializer_list<LogField> fields) {
  Log(LogLevel::kDebug, event, {fields.begin(), fields.size()});
}
void LogInfo(std::string_view event, std::initializer_list<LogField> fields) {
  Log(LogLevel::kInfo, event, {fields.begin(), fields.size()});
}
void LogWarning(std::string_view event, std::initializer_list<LogField> fields) {
  Log(LogLevel::kWarning, event, {fields.begin(), fields.size()});
}
void LogError(std::string_view event, std::initializer_list<LogField> fields) {
  Log(LogLevel::kError, event, {fields.begin(), fields.size()});
}

Status SetLogLevel(std::string_view level) {
  constexpr std::array<std::pair<std::string_view, spdlog::level::level_enum>, 5> kLevels{{
      {"debug", spdlog::level::debug},
      {"info", spdlog::level::info},
      {"warning", spdlog::level::warn},
      {"error", spdlog::level::err},
      {"off", spdlog::level::off},
  }};
  for (const auto& [name, value] : kLevels) {
    if (name == level) {
      Logger().set_level(value);
      return {};
    }
  }
  return InvalidArgument("log level is '" + std::string(level) + "', expected debug, info, warning, error or off");
}

}  // namespace depthfarm
