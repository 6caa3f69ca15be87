#ifndef DEPTHFARM_TESTS_BENCHMARKS_PROCESS_METER_H_
#define DEPTHFARM_TESTS_BENCHMARKS_PROCESS_METER_H_

#include <sys/types.h>

namespace depthfarm::benchmarks {

// What a process, this one or a child, used between two looks at it. Linux only: reads and writes /proc.
class ProcessMeter {
 public:
  explicit ProcessMeter(pid_t process) : process_(process) {}

  // From here on.
  void Start();
  // CPU seconds of all its threads since Start.
  [[nodiscard]] double CpuSeconds() const;
  // How far its resident memory rose above what it was at Start, MiB. 0 where the kernel does not tell.
  [[nodiscard]] double PeakMebibytes() const;

 private:
  pid_t process_;
  double cpu_seconds_ = 0;
  double kibibytes_ = 0;
};

}  // namespace depthfarm::benchmarks

#endif  // DEPTHFARM_TESTS_BENCHMARKS_PROCESS_METER_H_
