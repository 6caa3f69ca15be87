#ifndef DEPTHFARM_WORKER_MINDING_MINDER_H_
#define DEPTHFARM_WORKER_MINDING_MINDER_H_

#include <signal.h>

#include <functional>

#include "common/base/status.h"
#include "worker/minding/minded_end.h"

namespace depthfarm {

// What the minder sends to the process that it minds when it gets SIGTERM or SIGINT, and SIGHUP. Signals of their own,
// since those may come to both: from a terminal to its whole process group, from a service manager to all of a service.
// A second request to stop means more than one that comes twice. Real-time signals: batch systems send SIGUSR1 and
// SIGUSR2 of themselves.
[[nodiscard]] inline int MindedStop() { return SIGRTMIN + 1; }
[[nodiscard]] inline int MindedHangup() { return SIGRTMIN + 2; }

struct MindOptions {
  bool hangup = false;           // pass on SIGHUP; else it does what it always does
  bool end_with_parent = false;  // stop the minded process when the one that started this one ends
};

// Runs `work` in a child process, whose exit code it returns, and minds it from this one until it has ended, however it
// does: a process that was killed can't tell of it any more. All that the child writes to stderr goes where this one's
// does, and its end is kept. The child is killed when this process is.
//
// SIGTERM, SIGINT (and SIGHUP) of this process are passed on as above; the child ignores its own. Handlers of
// MindedStop and MindedHangup must be there before the call. Call it before there are other threads.
// kUnavailable: there can be no such process.
[[nodiscard]] Result<MindedEnd> RunMinded(const MindOptions& options, const std::function<int()>& work);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MINDING_MINDER_H_
