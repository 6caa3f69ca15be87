#include "common/log/log_collector.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <streambuf>
#include <utility>

#include "common/log/log.h"
#include "common/text/clean_line.h"

namespace depthfarm {
namespace {

thread_local LogCollector* collector_of_thread = nullptr;

// Hands what was written to the descriptor of stderr and to the thread's collector.
void PassOn(std::string_view text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t wrote = write(STDERR_FILENO, text.data() + done, text.size() - done);
    if (wrote < 0 && errno != EINTR) break;  // nobody reads it: as with the usual stderr
    if (wrote > 0) done += static_cast<std::size_t>(wrote);
  }
  if (LogCollector* collector = LogCollector::OfThread()) collector->AddText(text);
}

// Unbuffered, as std::cerr is.
class PassingBuffer : public std::streambuf {
 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    PassOn({text, static_cast<std::size_t>(count)});
    return count;
  }
  int_type overflow(int_type character) override {
    if (traits_type::eq_int_type(character, traits_type::eof())) return traits_type::not_eof(character);
    const char text = traits_type::to_char_type(character);
    PassOn({&text, 1});
    return character;
  }
};

ssize_t WriteFromC(void*, const char* text, std::size_t count) {
  PassOn({text, count});
  return static_cast<ssize_t>(count);
}

}  // namespace

LogCollector::LogCollector(const Bounds& bounds) : bounds_(bounds) { collector_of_thread = this; }

LogCollector::~LogCollector() { collector_of_thread = nullptr; }

LogCollector* LogCollector::OfThread() { return collector_of_thread; }

void LogCollector::Add(std::string_view line) {
  lines_.push_back(CleanLine(line, bounds_.line_bytes));
  bytes_ += lines_.back().size();
  while (lines_.size() > bounds_.lines || bytes_ > bounds_.bytes) {
    bytes_ -= lines_.front().size();
    lines_.pop_front();
    ++left_out_;
  }
}

void LogCollector::AddText(std::string_view text) {
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    begun_ += text.substr(0, end);
    EndLine();
    text.remove_prefix(end + 1);
  }
  // What is longer is cut anyhow: a line that never ends takes no more memory.
  const std::size_t room = 2 * bounds_.line_bytes - std::min(begun_.size(), 2 * bounds_.line_bytes);
  begun_ += text.substr(0, room);
}

void LogCollector::EndLine() {
  const std::string line = std::exchange(begun_, {});
  if (!line.empty() && !IsRoutineLine(line)) Add(line);
}

std::vector<std::string> LogCollector::TakeLines() {
  EndLine();
  std::vector<std::string> lines(std::make_move_iterator(lines_.begin()), std::make_move_iterator(lines_.end()));
  lines_.clear();
  bytes_ = 0;
  return lines;
}

void CaptureStandardError() {
  LogDebug("stderr_captured");                    // the logger keeps the stderr that it finds first
  static auto* const buffer = new PassingBuffer;  // std::cerr uses it until the process is gone
  std::cerr.rdbuf(buffer);
  // glibc lets a program set stderr, and libraries read the variable at each use. Without a buffer each printf is one
  // write, in the thread that prints.
  FILE* passing = fopencookie(nullptr, "w", {.read = nullptr, .write = WriteFromC, .seek = nullptr, .close = nullptr});
  if (passing == nullptr) return;
  if (std::setvbuf(passing, nullptr, _IONBF, 0) == 0) {
    stderr = passing;
  } else {
    std::fclose(passing);
  }
}

}  // namespace depthfarm
