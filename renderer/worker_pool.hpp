// SPDX-License-Identifier: Apache-2.0
// A few threads that share the loop iterations of one ping.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace sonard::render {

/// Runs independent jobs on all cores. Any thread may run any job, so a job must write only to its own data.
/// Results are then the same for any number of threads. One caller at a time.
///
/// A ping is a few loops in quick succession, each a fraction of a millisecond. A waiting thread therefore
/// spins for some tens of microseconds before it sleeps in the kernel: workers wait for the next loop, the
/// caller for the end of this one. Between pings all workers sleep. A worker that wakes late costs nothing:
/// the other threads have done its share.
class WorkerPool {
 public:
  /// @param threads total number of threads including the caller; 0: one per usable core.
  /// @throws std::system_error if a thread cannot be started
  explicit WorkerPool(unsigned threads = 0);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Threads that share the jobs, including the caller; >= 1.
  unsigned size() const { return static_cast<unsigned>(threads_.size()) + 1; }

  /// Calls job(0) ... job(count - 1), each once, and returns when all are done.
  /// @throws the exception of a job, the first one if several jobs throw
  void run(int count, const std::function<void(int)>& job);

 private:
  void end_threads();
  void work();
  void take_jobs();
  void do_job(int number);
  void sleep_until_jobs();
  void sleep_until_done();

  static constexpr int stopped = -1;

  // Written by the caller while `unclaimed_` is 0, read by a thread that has claimed a job. run() waits for
  // claimed jobs, so neither value changes while a thread reads it.
  const std::function<void(int)>* job_ = nullptr;
  int count_ = 0;
  std::atomic<int> unclaimed_{0};   ///< jobs of this run that are not claimed; `stopped` at destruction
  std::atomic<int> unfinished_{0};  ///< jobs of this run that are not done
  std::exception_ptr thrown_;       ///< by a job of this run; guarded by the mutex until all are done

  // For sleeping only. Under the mutex, a thread announces that it will sleep and then reads the numbers
  // above once more. A thread that changes the numbers checks for such an announcement afterwards. All these
  // accesses are sequentially consistent, so at least one thread sees the other's write. No wake-up is lost,
  // and no system call is useless.
  std::mutex mutex_;
  std::condition_variable jobs_, done_;
  std::atomic<int> sleeping_workers_{0};
  std::atomic<bool> caller_sleeps_{false};

  bool may_spin_;
  std::atomic<int> caller_core_{-1};
  std::vector<std::thread> threads_;
};

}  // namespace sonard::render
