#include "common/transport/authenticator.h"

#include <signal.h>  // NOLINT(modernize-deprecated-headers): pthread_sigmask is POSIX
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <utility>

namespace depthfarm {
namespace {

constexpr const char* kZapEndpoint = "inproc://zeromq.zap.01";
// Frames of a request: version, request id, domain, address, identity, mechanism, credentials.
constexpr std::size_t kRequestFrames = 7;
constexpr std::size_t kCurveKeyBytes = 32;

std::vector<std::string> ReceiveFrames(zmq::socket_t& socket) {
  std::vector<std::string> frames;
  zmq::message_t frame;
  do {
    if (!socket.recv(frame)) break;
    frames.push_back(frame.to_string());
  } while (frame.more());
  return frames;
}

void SendFrames(zmq::socket_t& socket, const std::vector<std::string>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto flags = i + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none;
    socket.send(zmq::buffer(frames[i]), flags);
  }
}

}  // namespace

Result<std::unique_ptr<Authenticator>> Authenticator::Start(zmq::context_t& context, const AdmittedKeys& admitted) {
  try {
    std::unique_ptr<Authenticator> authenticator(new Authenticator);
    authenticator->stop_fd_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (authenticator->stop_fd_ < 0) return Unavailable("cannot make an event descriptor for authentication");
    zmq::socket_t requests(context, zmq::socket_type::rep);
    requests.set(zmq::sockopt::linger, 0);
    requests.bind(kZapEndpoint);
    authenticator->thread_ = std::thread([socket = std::move(requests), fd = authenticator->stop_fd_,
                                          &admitted]() mutable { Serve(std::move(socket), fd, admitted); });
    return authenticator;
  } catch (const std::exception& error) {
    return Internal(std::string("cannot start authentication: ") + error.what());
  }
}

Authenticator::~Authenticator() {
  if (thread_.joinable()) {
    const std::uint64_t one = 1;
    if (::write(stop_fd_, &one, sizeof(one)) < 0) std::abort();  // an eventfd at 0 always takes 1
    thread_.join();
  }
  if (stop_fd_ >= 0) ::close(stop_fd_);
}

std::vector<std::string> Authenticator::Answer(const std::vector<std::string>& request, const AdmittedKeys& admitted) {
  if (request.size() < kRequestFrames - 1 || request[0] != "1.0") return {};
  const std::string& id = request[1];
  const bool curve = request.size() == kRequestFrames && request[5] == "CURVE" && request[6].size() == kCurveKeyBytes;
  if (curve) {
    std::array<char, 41> text{};
    zmq_z85_encode(text.data(), reinterpret_cast<const std::uint8_t*>(request[6].data()), kCurveKeyBytes);
    if (admitted.UserOf(text.data())) return {"1.0", id, "200", "OK", text.data(), ""};
  }
  return {"1.0", id, "400", curve ? "unknown key" : "only CURVE is accepted", "", ""};
}

void Authenticator::Serve(zmq::socket_t requests, int stop_fd, const AdmittedKeys& admitted) {
  // Signals are for the program's own threads: no call below is to fail by one.
  sigset_t all;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
  try {
    for (;;) {
      std::array<zmq::pollitem_t, 2> items{{{requests.handle(), 0, ZMQ_POLLIN, 0}, {nullptr, stop_fd, ZMQ_POLLIN, 0}}};
      try {
        zmq::poll(items, std::chrono::milliseconds(-1));
      } catch (const zmq::error_t& error) {
        if (error.num() == EINTR) continue;
        throw;
      }
      if (items[1].revents != 0) return;
      const std::vector<std::string> request = ReceiveFrames(requests);
      std::vector<std::string> answer = Answer(request, admitted);
      // REP must answer before it may receive again; libzmq drops the handshake of an answer it cannot read.
      if (answer.empty()) answer = {"1.0", request.size() > 1 ? request[1] : "", "500", "malformed request", "", ""};
      SendFrames(requests, answer);
    }
  } catch (const zmq::error_t& error) {
    // Without this thread libzmq would admit every key: only the end of the context may end it.
    if (error.num() != ETERM) std::abort();
  }
}

}  // namespace depthfarm
