#include "tests/system/long_cable.h"

#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <optional>
#include <system_error>

namespace depthfarm::system_test {
namespace {

constexpr const char* kTun = "/dev/net/tun";
// A frame of the usual MTU and its headers are far below it; the kernel cuts larger ones for a TAP.
constexpr std::size_t kMostBytes = 65536;
// How late the carrier may notice that it is to end, or that Set was called.
constexpr std::chrono::milliseconds kPause{20};

// A TAP device, or -1 with errno.
int MakeDevice(const std::string& name) {
  const int device = ::open(kTun, O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (device < 0) return -1;
  ifreq request{};
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  name.copy(static_cast<char*>(request.ifr_name), IFNAMSIZ - 1);
  if (::ioctl(device, TUNSETIFF, &request) == 0) return device;
  const int why = errno;
  (void)::close(device);
  errno = why;
  return -1;
}

}  // namespace

LongCable::LongCable(const std::string& end, const std::string& other_end)
    : ends_{End{.to_here = DelayLine(1)}, End{.to_here = DelayLine(2)}} {
  ends_[0].device = MakeDevice(end);
  if (ends_[0].device >= 0) ends_[1].device = MakeDevice(other_end);
  if (ends_[0].device < 0 || ends_[1].device < 0) {
    problem_ = std::string("cannot make a cable of TAP devices (") + kTun +
               ") here: " + std::generic_category().message(errno);
    return;
  }
  carrier_ = std::jthread([this](const std::stop_token& stop) { Carry(stop); });
}

LongCable::~LongCable() {
  carrier_ = {};  // which reads from the devices
  for (const End& end : ends_) {
    if (end.device >= 0) (void)::close(end.device);
  }
}

void LongCable::Set(const LongWay& way) {
  const std::scoped_lock lock(lines_);
  for (End& end : ends_) end.to_here.Set(way);
}

void LongCable::TakeFrom(const End& end, DelayLine& to_other) const {
  std::string frame(kMostBytes, '\0');
  for (;;) {
    const ssize_t bytes = ::read(end.device, frame.data(), frame.size());
    if (bytes <= 0) return;
    to_other.Push(frame.substr(0, static_cast<std::size_t>(bytes)), DelayLine::TimePoint::clock::now());
  }
}

void LongCable::Carry(const std::stop_token& stop) {
  using Clock = DelayLine::TimePoint::clock;
  while (!stop.stop_requested()) {
    auto wait = std::chrono::duration_cast<std::chrono::nanoseconds>(kPause);
    {
      const std::scoped_lock lock(lines_);
      for (End& end : ends_) {
        while (const std::optional<std::string> frame = end.to_here.Pop(Clock::now())) {
          // A device that is not up, or whose queue is full, loses it, as a cable does.
          (void)!::write(end.device, frame->data(), frame->size());
        }
        if (const auto next = end.to_here.NextArrival()) {
          wait = std::min<std::chrono::nanoseconds>(wait, *next - Clock::now());
        }
      }
    }
    const timespec until{.tv_sec = 0, .tv_nsec = std::max<std::chrono::nanoseconds::rep>(wait.count(), 0)};
    std::array<pollfd, 2> devices{pollfd{.fd = ends_[0].device, .events = POLLIN, .revents = 0},
                                  pollfd{.fd = ends_[1].device, .events = POLLIN, .revents = 0}};
    (void)::ppoll(devices.data(), devices.size(), &until, nullptr);
    const std::scoped_lock lock(lines_);
    TakeFrom(ends_[0], ends_[1].to_here);
    TakeFrom(ends_[1], ends_[0].to_here);
  }
}

}  // namespace depthfarm::system_test
