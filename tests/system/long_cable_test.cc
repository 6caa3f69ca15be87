// That the cable of the network tests does what they believe.
#include "tests/system/long_cable.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <vector>

#include "tests/system/delay_line.h"
#include "tests/system/network_lab.h"

namespace depthfarm::system_test {
namespace {

using namespace std::chrono_literals;
using TimePoint = DelayLine::TimePoint;

TEST(DelayLine, HoldsWhatIsSentForAsLongAsTheWayTakes) {
  DelayLine line(1);
  line.Set({.delay = 80ms});
  EXPECT_EQ(line.NextArrival(), std::nullopt);
  line.Push("one", TimePoint(1s));
  EXPECT_EQ(line.NextArrival(), TimePoint(1080ms));
  EXPECT_EQ(line.Pop(TimePoint(1079ms)), std::nullopt);
  EXPECT_EQ(line.Pop(TimePoint(1080ms)), "one");
  EXPECT_EQ(line.NextArrival(), std::nullopt);
}

TEST(DelayLine, HasNothingOvertakeWhateverTheJitterAndHoweverShortTheWayBecomes) {
  DelayLine line(1);
  line.Set({.delay = 80ms, .jitter = 80ms});
  for (int i = 0; i < 100; ++i) line.Push(std::to_string(i), TimePoint(1s + i * 1ms));
  line.Set({});
  line.Push("100", TimePoint(1s + 100ms));
  TimePoint last;
  for (int i = 0; i <= 100; ++i) {
    const TimePoint arrival = line.NextArrival().value();
    EXPECT_GE(arrival, last);
    EXPECT_GE(arrival, TimePoint(1s + i * 1ms));
    EXPECT_LE(arrival, TimePoint(1s + 99ms + 160ms));
    EXPECT_EQ(line.Pop(arrival), std::to_string(i));
    last = arrival;
  }
}

TEST(DelayLine, OfABoundedRateSendsOneAfterTheOtherAndDropsWhatDoesNotFit) {
  DelayLine line(1);
  line.Set({.delay = 10ms, .bytes_per_second = 1000});
  for (int i = 0; i < 2000; ++i) line.Push(std::string(100, 'x'), TimePoint(1s));
  EXPECT_EQ(line.NextArrival(), TimePoint(1110ms));
  int arrived = 0;
  while (line.Pop(TimePoint(1000s))) ++arrived;
  EXPECT_EQ(arrived, 1000);
}

// A UDP socket of the host this thread is on.
class Socket {
 public:
  explicit Socket(int host) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_in here = Address(host);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof here), 0);
    const timeval patience{.tv_sec = 20, .tv_usec = 0};
    (void)::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~Socket() { (void)::close(socket_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void Send(int host, const std::string& text) const {
    const sockaddr_in there = Address(host);
    EXPECT_EQ(::sendto(socket_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&there), sizeof there),
              static_cast<ssize_t>(text.size()));
  }
  // Empty when nothing comes.
  [[nodiscard]] std::string Receive() const {
    std::string text(2000, '\0');
    const ssize_t bytes = ::recv(socket_, text.data(), text.size(), 0);
    text.resize(bytes > 0 ? static_cast<std::size_t>(bytes) : 0);
    return text;
  }

 private:
  static sockaddr_in Address(int host) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(7);
    (void)::inet_pton(AF_INET, NetworkLab::AddressOf(host).c_str(), &address.sin_addr);
    return address;
  }
  int socket_;
};

TEST(NetworkLab, OfALongCableDelaysEachWayAndKeepsTheOrder) {
  NetworkLab lab(2);
  if (!lab.problem().empty()) GTEST_SKIP() << lab.problem();
  const std::string problem = lab.Delay(1, {.delay = 80ms, .jitter = 20ms});
  if (!problem.empty()) GTEST_SKIP() << problem;
  const auto socket_on = [&](int host) {
    const NetworkLab::On on(lab, host);
    return std::make_unique<Socket>(host);
  };
  const auto here = socket_on(0);
  const auto there = socket_on(1);
  constexpr int kSent = 50;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kSent; ++i) here->Send(1, std::to_string(i));
  for (int i = 0; i < kSent; ++i) ASSERT_EQ(there->Receive(), std::to_string(i));
  EXPECT_GE(std::chrono::steady_clock::now() - start, 60ms);
  there->Send(0, "and back");
  EXPECT_EQ(here->Receive(), "and back");
  EXPECT_GE(std::chrono::steady_clock::now() - start, 120ms);
}

}  // namespace
}  // namespace depthfarm::system_test
