// Loaded before the libraries of a program (LD_PRELOAD), moves its clock of the day by the seconds in the file that
// DEPTHFARM_CLOCK_OFFSET names: a number of eight bytes, which may change at any time. The clocks that only go forward
// are left alone, as they are when an administrator or NTP sets the time.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>  // NOLINT(modernize-deprecated-headers): its functions are replaced here
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace {

// Mapped, so that a look costs nothing and cannot fail half-way. Never unmapped: others may look until the very end.
const volatile std::int64_t* MapOffset() {
  const char* name = std::getenv("DEPTHFARM_CLOCK_OFFSET");  // NOLINT(concurrency-mt-unsafe): nobody sets it
  const int file = name == nullptr ? -1 : open(name, O_RDONLY | O_CLOEXEC);
  if (file < 0) return nullptr;
  void* mapped = mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
  close(file);
  return mapped == MAP_FAILED ? nullptr : static_cast<const volatile std::int64_t*>(mapped);
}

std::int64_t OffsetSeconds() {
  static const volatile std::int64_t* const offset = MapOffset();
  return offset == nullptr ? 0 : *offset;
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* now) noexcept {
  const auto result = static_cast<int>(syscall(SYS_clock_gettime, clock, now));
  if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) now->tv_sec += OffsetSeconds();
  return result;
}

int gettimeofday(timeval* now, void* /*zone*/) noexcept {
  timespec time{};
  if (clock_gettime(CLOCK_REALTIME, &time) != 0) return -1;
  *now = {.tv_sec = time.tv_sec, .tv_usec = time.tv_nsec / 1000};
  return 0;
}

time_t time(time_t* copy) noexcept {
  timespec now{};
  if (clock_gettime(CLOCK_REALTIME, &now) != 0) return -1;
  if (copy != nullptr) *copy = now.tv_sec;
  return now.tv_sec;
}

}  // extern "C"
