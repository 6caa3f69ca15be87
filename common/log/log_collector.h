#ifndef DEPTHFARM_COMMON_LOG_LOG_COLLECTOR_H_
#define DEPTHFARM_COMMON_LOG_LOG_COLLECTOR_H_

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace depthfarm {

// Keeps the last of the warnings and errors that the thread which made it logs while it lives, whatever SetLogLevel
// says ("warning event key=value"); after CaptureStandardError also what libraries write to stderr in that thread. What
// other threads log is not among it. One at a time per thread, ended in the thread that made it.
class LogCollector {
 public:
  // A line longer than `max_line_bytes` is cut.
  struct Bounds {
    std::size_t lines = 64;
    std::size_t bytes = 16384;  // of all lines
    std::size_t line_bytes = 2048;
  };
  explicit LogCollector(const Bounds& bounds);
  ~LogCollector();
  LogCollector(const LogCollector&) = delete;
  LogCollector& operator=(const LogCollector&) = delete;

  // Oldest first, each one line of valid UTF-8 (CleanLine).
  [[nodiscard]] std::vector<std::string> TakeLines();
  // How many lines there were before those.
  [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

  // That of the calling thread; null when there is none.
  [[nodiscard]] static LogCollector* OfThread();
  void Add(std::string_view line);
  // A piece of what was written to stderr: lines end with '\n'. Routine lines of Log (IsRoutineLine), as another
  // process writes them, are passed over.
  void AddText(std::string_view text);

 private:
  // The line that was begun has ended.
  void EndLine();

  const Bounds bounds_;
  std::deque<std::string> lines_;
  std::size_t bytes_ = 0;
  std::uint64_t left_out_ = 0;
  std::string begun_;  // a line that has not ended
};

// From now on what is written through std::cerr, or as C's stderr is used by libraries (libpng, libjpeg, FFmpeg), still
// goes where it went, and to the collector of the thread that writes. Lines of Log are not doubled. What is written to
// file descriptor 2 past both is not seen. Call it once, before there are other threads.
void CaptureStandardError();

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_LOG_LOG_COLLECTOR_H_
