#include "common/transport/poller.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>
#include <zmq.hpp>

namespace depthfarm {

Poller::Poller() : wake_fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (wake_fd_ < 0) std::abort();  // out of descriptors at start: nothing can work
}

Poller::~Poller() { ::close(wake_fd_); }

Status Poller::Wait(std::span<const Channel* const> channels, std::chrono::milliseconds timeout) {
  std::vector<zmq::pollitem_t> items;
  items.reserve(channels.size() + 1);
  items.push_back({nullptr, wake_fd_, ZMQ_POLLIN, 0});
  for (const Channel* channel : channels) items.push_back({channel->native_socket(), 0, ZMQ_POLLIN, 0});
  try {
    zmq::poll(items, std::max(timeout, std::chrono::milliseconds(0)));
  } catch (const zmq::error_t& error) {
    if (error.num() == EINTR) return {};
    return Internal(std::string("waiting for messages failed: ") + error.what());
  }
  if (items[0].revents != 0) {
    std::uint64_t count = 0;
    if (::read(wake_fd_, &count, sizeof(count)) < 0 && errno != EAGAIN)
      return Internal("the wake-up descriptor failed");
  }
  return {};
}

void Poller::Wake() {
  const int saved = errno;  // a signal handler must leave it alone
  const std::uint64_t one = 1;
  // Fails only when the counter is full, and then the wake-up is pending anyway.
  [[maybe_unused]] const auto written = ::write(wake_fd_, &one, sizeof(one));
  errno = saved;
}

}  // namespace depthfarm
