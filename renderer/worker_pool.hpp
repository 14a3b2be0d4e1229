// A few threads that share the loop iterations of one ping.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace sonard::render {

/// Runs independent jobs on all cores. Which thread runs which job is left open, so a job must write only
/// what is its own; results are then the same for any number of threads. One caller at a time.
class WorkerPool {
 public:
  /// @param threads total number of threads including the caller; 0: one per core.
  explicit WorkerPool(unsigned threads = 0);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Calls job(0) ... job(count - 1), each once, and returns when all are done. Jobs must not throw.
  void run(int count, const std::function<void(int)>& job);

 private:
  void work();
  void take_jobs(const std::function<void(int)>& job, int count);

  std::mutex mutex_;
  std::condition_variable start_;
  std::condition_variable done_;
  const std::function<void(int)>* job_ = nullptr;  // guarded by mutex_, like all below but next_
  int count_ = 0;
  std::uint64_t generation_ = 0;
  unsigned busy_ = 0;
  bool stop_ = false;
  std::atomic<int> next_{0};
  std::vector<std::thread> threads_;
};

}  // namespace sonard::render
