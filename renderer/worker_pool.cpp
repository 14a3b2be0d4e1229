#include "renderer/worker_pool.hpp"

#include <algorithm>

namespace sonard::render {

WorkerPool::WorkerPool(unsigned threads) {
  if (threads == 0) {
    threads = std::max(1U, std::thread::hardware_concurrency());
  }
  for (unsigned i = 1; i < threads; ++i) {
    threads_.emplace_back([this] { work(); });
  }
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  start_.notify_all();
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
  {
    const std::lock_guard lock(mutex_);
    job_ = &job;
    count_ = count;
    next_.store(0, std::memory_order_relaxed);
    busy_ = static_cast<unsigned>(threads_.size());
    ++generation_;
  }
  start_.notify_all();
  take_jobs(job, count);
  // Every worker reports back before `job` and `next_` may change, so none can see a later run's jobs as its
  // own.
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return busy_ == 0; });
}

void WorkerPool::take_jobs(const std::function<void(int)>& job, int count) {
  for (int i = next_.fetch_add(1); i < count; i = next_.fetch_add(1)) {
    job(i);
  }
}

void WorkerPool::work() {
  std::uint64_t seen = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    start_.wait(lock, [&] { return stop_ || generation_ != seen; });
    if (stop_) {
      return;
    }
    seen = generation_;
    const std::function<void(int)>& job = *job_;
    const int count = count_;
    lock.unlock();
    take_jobs(job, count);
    lock.lock();
    if (--busy_ == 0) {
      done_.notify_one();
    }
  }
}

}  // namespace sonard::render
