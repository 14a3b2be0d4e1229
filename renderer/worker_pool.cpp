// SPDX-License-Identifier: Apache-2.0
#include "renderer/worker_pool.hpp"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "renderer/usable_cores.hpp"

namespace sonard::render {

namespace {

using std::chrono::microseconds;

// Covers the serial parts between the loops of a ping: to wake a sleeping worker takes 5 to 20 us.
constexpr microseconds worker_spin{50};
// Covers the rest of the last jobs.
constexpr microseconds caller_spin{20};

/// Frees the core for its other hardware thread, and keeps the loop from flooding the memory bus.
inline void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

/// Returns when `wanted` accepts `value`, or after `longest`.
template <class Wanted>
void spin_until(const std::atomic<int>& value, microseconds longest, Wanted wanted) {
  const auto end = std::chrono::steady_clock::now() + longest;
  do {
    for (int i = 0; i < 32; ++i) {
      if (wanted(value.load(std::memory_order_relaxed))) {
        return;
      }
      pause();
    }
  } while (std::chrono::steady_clock::now() < end);
}

}  // namespace

WorkerPool::WorkerPool(unsigned threads) {
  const unsigned cores = usable_cores();
  if (threads == 0) {
    threads = cores;
  }
  may_spin_ = threads <= cores;  // else spinning threads would block threads with work
  try {
    for (unsigned i = 1; i < threads; ++i) {
      threads_.emplace_back([this] { work(); });
    }
  } catch (...) {
    end_threads();
    throw;
  }
}

WorkerPool::~WorkerPool() {
  end_threads();
}

void WorkerPool::end_threads() {
  {
    const std::lock_guard lock(mutex_);
    unclaimed_ = stopped;
  }
  jobs_.notify_all();
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

void WorkerPool::run(int count, const std::function<void(int)>& job) {
  if (threads_.empty() || count <= 1) {
    for (int i = 0; i < count; ++i) {
      job(i);
    }
    return;
  }
  job_ = &job;
  count_ = count;
  unfinished_.store(count, std::memory_order_relaxed);
  caller_core_.store(sched_getcpu(), std::memory_order_relaxed);
  unclaimed_.store(count);
  if (sleeping_workers_ > 0) {
    mutex_.lock();  // a worker holds the mutex from its announcement until it sleeps
    mutex_.unlock();
    jobs_.notify_all();
  }
  take_jobs();
  if (may_spin_) {
    spin_until(unfinished_, caller_spin, [](int left) { return left == 0; });
  }
  if (unfinished_ != 0) {
    sleep_until_done();
  }
  if (thrown_) {
    std::rethrow_exception(std::exchange(thrown_, nullptr));
  }
}

void WorkerPool::do_job(int number) {
  try {
    (*job_)(number);
  } catch (...) {  // most likely out of memory; other jobs still use the caller's data
    const std::lock_guard lock(mutex_);
    if (!thrown_) {
      thrown_ = std::current_exception();
    }
  }
}

void WorkerPool::take_jobs() {
  int done = 0;
  int unclaimed = unclaimed_.load();
  while (unclaimed > 0) {
    if (unclaimed_.compare_exchange_weak(unclaimed, unclaimed - 1)) {
      do_job(count_ - unclaimed);
      ++done;
      unclaimed = unclaimed_.load();
    }
  }
  if (done > 0 && unfinished_.fetch_sub(done) == done && caller_sleeps_) {
    mutex_.lock();
    mutex_.unlock();
    done_.notify_one();
  }
}

void WorkerPool::sleep_until_jobs() {
  std::unique_lock lock(mutex_);
  ++sleeping_workers_;
  jobs_.wait(lock, [this] { return unclaimed_ != 0; });
  --sleeping_workers_;
}

void WorkerPool::sleep_until_done() {
  std::unique_lock lock(mutex_);
  caller_sleeps_ = true;
  done_.wait(lock, [this] { return unfinished_ == 0; });
  caller_sleeps_ = false;
}

void WorkerPool::work() {
  while (unclaimed_ != stopped) {
    take_jobs();
    // On a busy machine the kernel often wakes a worker on the caller's core. The worker must then free that
    // core.
    if (may_spin_ && sched_getcpu() != caller_core_.load(std::memory_order_relaxed)) {
      spin_until(unclaimed_, worker_spin, [](int unclaimed) { return unclaimed != 0; });
    }
    if (unclaimed_ == 0) {
      sleep_until_jobs();
    }
  }
}

}  // namespace sonard::render
