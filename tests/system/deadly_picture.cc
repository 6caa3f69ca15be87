// Loaded before the libraries of a program (LD_PRELOAD), kills a worker that opens the file which
// DEPTHFARM_DEADLY_PICTURE names, after a word on stderr: past all that the program knows of its own log, as a library
// or a sanitizer does that finds its process beyond hope.
#include <errno.h>  // NOLINT(modernize-deprecated-headers): program_invocation_short_name is GNU's
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdlib>
#include <cstring>

namespace {

void DieOf(const char* path) {
  const char* deadly = std::getenv("DEPTHFARM_DEADLY_PICTURE");  // NOLINT(concurrency-mt-unsafe): nobody sets it
  if (deadly == nullptr || std::strcmp(path, deadly) != 0) return;
  if (std::strcmp(program_invocation_short_name, "depthfarm-worker") != 0) return;
  constexpr char kWords[] = "deadly picture: the heap is not what it was\n";
  (void)!write(STDERR_FILENO, static_cast<const char*>(kWords), sizeof kWords - 1);
  std::abort();
}

int Open(const char* path, int flags, mode_t mode) {
  DieOf(path);
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

}  // namespace

extern "C" {

// The mode is there where the flags say so.
#define DEPTHFARM_MODE_OF(flags)                        \
  mode_t mode = 0;                                      \
  if (((flags) & (O_CREAT | O_TMPFILE)) != 0) {         \
    va_list arguments;                                  \
    va_start(arguments, flags);                         \
    mode = static_cast<mode_t>(va_arg(arguments, int)); \
    va_end(arguments);                                  \
  }

int open(const char* path, int flags, ...) {
  DEPTHFARM_MODE_OF(flags)
  return Open(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  DEPTHFARM_MODE_OF(flags)
  return Open(path, flags | O_LARGEFILE, mode);
}

}  // extern "C"
