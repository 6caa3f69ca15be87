#ifndef DEPTHFARM_COMMON_BASE_THREAD_BUDGET_H_
#define DEPTHFARM_COMMON_BASE_THREAD_BUDGET_H_

#include <algorithm>
#include <atomic>

namespace depthfarm {

// Threads that tasks share, so that together they keep as many cores busy as there are: each task has one, and each of
// its loops (parallel.h) takes of those that are idle when it begins, for as long as it lasts. Thread-safe.
class ThreadBudget {
 public:
  // `threads`: how many there are.
  explicit ThreadBudget(int threads) : idle_(threads) {}
  ThreadBudget(const ThreadBudget&) = delete;
  ThreadBudget& operator=(const ThreadBudget&) = delete;

  // While it lives, the thread that made it computes a task of the budget. It begins at once: where the loops of other
  // tasks have all threads there is one too many until one of those loops ends.
  class Task {
   public:
    explicit Task(ThreadBudget& budget) : budget_(budget), outer_(of_thread_) {
      --budget.idle_;
      of_thread_ = &budget;
    }
    ~Task() {
      of_thread_ = outer_;
      ++budget_.idle_;
    }
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

   private:
    ThreadBudget& budget_;
    ThreadBudget* const outer_;
  };

  // How many helpers a loop of this thread would get now.
  [[nodiscard]] static int IdleForThisThread(int most) {
    return of_thread_ == nullptr ? most : std::clamp<int>(of_thread_->idle_, 0, most);
  }

  // Threads beside the one that asks, given back when this goes: up to `most`, as many as its budget has left; `most`
  // where it computes no task of a budget.
  class Helpers {
   public:
    explicit Helpers(int most) : budget_(of_thread_), count_(budget_ == nullptr ? most : budget_->Take(most)) {}
    ~Helpers() {
      if (budget_ != nullptr) budget_->idle_ += count_;
    }
    Helpers(const Helpers&) = delete;
    Helpers& operator=(const Helpers&) = delete;
    [[nodiscard]] int count() const { return count_; }
    // To be called in each of them: its own loops ask the same budget.
    void Enter() const { of_thread_ = budget_; }

   private:
    ThreadBudget* const budget_;
    const int count_;
  };

 private:
  [[nodiscard]] int Take(int most) {
    int idle = idle_;
    int taken = 0;
    do {
      taken = std::clamp(idle, 0, most);
    } while (taken > 0 && !idle_.compare_exchange_weak(idle, idle - taken));
    return taken;
  }

  inline static thread_local ThreadBudget* of_thread_ = nullptr;
  std::atomic<int> idle_;  // below 0: tasks have begun beside loops that have all of them
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_THREAD_BUDGET_H_
