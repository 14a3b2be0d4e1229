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

/// Runs independent jobs on all cores. Which thread runs which job is left open, so a job must write only
/// what is its own; results are then the same for any number of threads. One caller at a time.
///
/// A ping is a few loops shortly after one another, each a fraction of a millisecond. A thread that waits
/// therefore spins for some tens of microseconds before it sleeps in the kernel: workers for the next loop,
/// the caller for the end of this one. Between pings all workers sleep. A worker that wakes late costs
/// nothing: the others have taken its share.
class WorkerPool {
 public:
  /// @param threads total number of threads including the caller; 0: one per usable core.
  /// @throws std::system_error when a thread cannot be started
  explicit WorkerPool(unsigned threads = 0);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Threads that share the jobs, the caller included; >= 1.
  unsigned size() const { return static_cast<unsigned>(threads_.size()) + 1; }

  /// Calls job(0) ... job(count - 1), each once, and returns when all are done.
  /// @throws what a job has thrown, the first one where several have
  void run(int count, const std::function<void(int)>& job);

 private:
  void end_threads();
  void work();
  void take_jobs();
  void do_job(int number);
  void sleep_until_jobs();
  void sleep_until_done();

  static constexpr int stopped = -1;

  // Written by the caller while `unclaimed_` is 0, read by a thread that has claimed a job. A claim holds
  // run() up until that job is done, so neither changes under a reader.
  const std::function<void(int)>* job_ = nullptr;
  int count_ = 0;
  std::atomic<int> unclaimed_{0};   ///< jobs of this run that are not claimed; `stopped` at the end
  std::atomic<int> unfinished_{0};  ///< jobs of this run that are not done
  std::exception_ptr thrown_;       ///< by a job of this run; under the mutex until all are done

  // For sleeping only. A thread about to sleep says so under the mutex before it reads the numbers above a
  // last time; a thread that changes them checks whether a thread said so after. In one order of all these
  // accesses (they are sequentially consistent) at least one sees the other, so no wake-up is lost, and none
  // costs a useless system call.
  std::mutex mutex_;
  std::condition_variable jobs_, done_;
  std::atomic<int> sleeping_workers_{0};
  std::atomic<bool> caller_sleeps_{false};

  bool may_spin_;
  std::atomic<int> caller_core_{-1};
  std::vector<std::thread> threads_;
};

}  // namespace sonard::render
