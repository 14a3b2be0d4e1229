#include "renderer/worker_pool.hpp"

#include <algorithm>
#include <chrono>

namespace sonard::render {

namespace {

// About twice what it takes to wake a thread that sleeps: longer spinning costs more than it saves.
constexpr std::chrono::microseconds longest_spin{50};

/// Lets the other half of a core run, and keeps the loop from flooding the memory bus.
inline void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

/// Returns when `value` is what `wanted` says, or after longest_spin.
template <class Wanted>
void spin_until(const std::atomic<int>& value, Wanted wanted) {
  const auto end = std::chrono::steady_clock::now() + longest_spin;
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
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  if (threads == 0) {
    threads = cores;
  }
  may_spin_ = threads <= cores;  // else spinning would keep a thread with work from running
  for (unsigned i = 1; i < threads; ++i) {
    threads_.emplace_back([this] { work(); });
  }
}

WorkerPool::~WorkerPool() {
  unclaimed_ = stopped;
  unclaimed_.notify_all();
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
  unclaimed_.store(count);
  unclaimed_.notify_all();
  take_jobs();
  if (may_spin_) {
    spin_until(unfinished_, [](int left) { return left == 0; });
  }
  for (int left = unfinished_.load(); left != 0; left = unfinished_.load()) {
    unfinished_.wait(left);
  }
}

void WorkerPool::take_jobs() {
  int done = 0;
  int unclaimed = unclaimed_.load();
  while (unclaimed > 0) {
    if (unclaimed_.compare_exchange_weak(unclaimed, unclaimed - 1)) {
      (*job_)(count_ - unclaimed);
      ++done;
      unclaimed = unclaimed_.load();
    }
  }
  if (done > 0 && unfinished_.fetch_sub(done) == done) {
    unfinished_.notify_one();
  }
}

void WorkerPool::work() {
  while (unclaimed_.load() != stopped) {
    take_jobs();
    if (may_spin_) {
      spin_until(unclaimed_, [](int unclaimed) { return unclaimed != 0; });
    }
    unclaimed_.wait(0);
  }
}

}  // namespace sonard::render
