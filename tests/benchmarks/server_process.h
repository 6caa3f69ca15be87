#ifndef DEPTHFARM_TESTS_BENCHMARKS_SERVER_PROCESS_H_
#define DEPTHFARM_TESTS_BENCHMARKS_SERVER_PROCESS_H_

#include <sys/types.h>

#include <functional>
#include <string>

namespace depthfarm::benchmarks {

// The serving end of a measurement, in a process of its own. Make it while this process has no other threads.
class ServerProcess {
 public:
  // Binds and returns the endpoint; called in the child. Returns a function that serves until the descriptor it is
  // given becomes readable.
  struct Served {
    std::string endpoint;  // empty: it failed
    std::function<void(int stop)> run;
  };
  explicit ServerProcess(const std::function<Served()>& serve);
  // Ends the child.
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  [[nodiscard]] pid_t process() const { return process_; }
  // Where the child listens; empty when it failed.
  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }

 private:
  pid_t process_ = -1;
  int stop_ = -1;  // the child serves as long as this is open
  std::string endpoint_;
};

}  // namespace depthfarm::benchmarks

#endif  // DEPTHFARM_TESTS_BENCHMARKS_SERVER_PROCESS_H_
