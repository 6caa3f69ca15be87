#include "tests/benchmarks/process_meter.h"

#include <time.h>  // NOLINT(modernize-deprecated-headers): clock_getcpuclockid is POSIX

#include <algorithm>
#include <fstream>
#include <string>

namespace depthfarm::benchmarks {
namespace {

constexpr double kKibibytesPerMebibyte = 1024;

std::string ProcFile(pid_t process, const std::string& name) { return "/proc/" + std::to_string(process) + "/" + name; }

double CpuSecondsOf(pid_t process) {
  clockid_t clock = {};
  timespec now = {};
  if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &now) != 0) return 0;
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A line "VmHWM:   1234 kB" of the status file; 0 without one.
double KibibytesOf(pid_t process, const std::string& field) {
  std::ifstream status(ProcFile(process, "status"));
  for (std::string word; status >> word;) {
    double kibibytes = 0;
    if (word == field && status >> kibibytes) return kibibytes;
  }
  return 0;
}

}  // namespace

void ProcessMeter::Start() {
  constexpr int kResetPeak = 5;  // of clear_refs: the peak becomes what is resident now
  std::ofstream(ProcFile(process_, "clear_refs")) << kResetPeak;
  kibibytes_ = KibibytesOf(process_, "VmRSS:");
  cpu_seconds_ = CpuSecondsOf(process_);
}

double ProcessMeter::CpuSeconds() const { return CpuSecondsOf(process_) - cpu_seconds_; }

double ProcessMeter::PeakMebibytes() const {
  return std::max(0.0, KibibytesOf(process_, "VmHWM:") - kibibytes_) / kKibibytesPerMebibyte;
}

}  // namespace depthfarm::benchmarks
