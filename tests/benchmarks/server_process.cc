#include "tests/benchmarks/server_process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>

namespace depthfarm::benchmarks {
namespace {

// Only whole pipes go on: without one the child could not be ended.
std::array<int, 2> Pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) std::abort();
  return ends;
}

[[noreturn]] void Serve(const std::function<ServerProcess::Served()>& serve, int answers, int stop) {
  {
    const ServerProcess::Served served = serve();
    const std::string line = served.endpoint + "\n";
    if (::write(answers, line.data(), line.size()) != static_cast<ssize_t>(line.size())) ::_exit(1);
    if (!served.endpoint.empty()) served.run(stop);
  }
  ::_exit(0);
}

std::string ReadLine(int descriptor) {
  std::string line;
  for (char byte = 0; ::read(descriptor, &byte, 1) == 1 && byte != '\n';) line += byte;
  return line;
}

}  // namespace

ServerProcess::ServerProcess(const std::function<Served()>& serve) {
  const std::array<int, 2> answers = Pipe();
  const std::array<int, 2> stop = Pipe();
  process_ = ::fork();
  if (process_ == 0) {
    ::close(stop[1]);
    Serve(serve, answers[1], stop[0]);
  }
  ::close(answers[1]);
  ::close(stop[0]);
  stop_ = stop[1];
  if (process_ > 0) endpoint_ = ReadLine(answers[0]);
  ::close(answers[0]);
}

ServerProcess::~ServerProcess() {
  // A byte, since children made later hold this end too: closing it alone would tell nobody.
  const char stop = 0;
  if (process_ > 0 && ::write(stop_, &stop, 1) != 1) ::kill(process_, SIGKILL);
  ::close(stop_);
  if (process_ > 0) ::waitpid(process_, nullptr, 0);
}

}  // namespace depthfarm::benchmarks
