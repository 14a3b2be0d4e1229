// SPDX-License-Identifier: Apache-2.0
// The queue from the serving threads to the recorder, which never makes the former wait.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <semaphore>
#include <vector>

#include "server/recording/events.hpp"

namespace sonard::server {

/// Events that found the queue full, by what is lost with them. They only grow.
struct DroppedEvents {
  std::uint64_t images = 0;  ///< pings and scan lines
  std::uint64_t pieces = 0;  ///< datagrams and pieces of streams
  std::uint64_t others = 0;  ///< statuses, poses, ends of streams

  std::uint64_t total() const { return images + pieces + others; }
};

/// Bounded by bytes, for any number of threads that push and one that takes. push() takes no lock and makes
/// no system call but the wake-up, so the taking thread, whatever its priority, cannot hold up a pushing one:
/// events are pushed onto a linked stack by compare-and-swap, and the taker swaps the whole of it out.
class EventQueue {
 public:
  explicit EventQueue(std::size_t most_bytes) : most_bytes_(most_bytes) {}
  ~EventQueue();
  EventQueue(const EventQueue&) = delete;
  EventQueue& operator=(const EventQueue&) = delete;

  /// @return false when it does not fit, and is dropped and counted.
  bool push(RecordingEvent event);
  /// Wakes the taker without an event.
  void wake() { news_.release(); }

  /// Waits until something was pushed, wake() was called or the time is over.
  void wait(std::chrono::milliseconds longest) { static_cast<void>(news_.try_acquire_for(longest)); }
  /// Takes all events in the order in which they were pushed. Their memory counts until done().
  std::vector<RecordingEvent> take();
  /// Frees the memory of a processed event.
  void done(const RecordingEvent& event);

  /// Any thread. Memory of the events that are not done yet.
  std::size_t bytes() const { return bytes_; }
  /// Any thread.
  DroppedEvents dropped() const;

 private:
  struct Node {
    RecordingEvent event;
    Node* next;
  };

  void count_dropped(const RecordingEvent& event);

  const std::size_t most_bytes_;
  std::atomic<Node*> newest_{nullptr};
  std::atomic<std::size_t> bytes_{0};
  std::counting_semaphore<> news_{0};
  std::atomic<std::uint64_t> dropped_images_{0};
  std::atomic<std::uint64_t> dropped_pieces_{0};
  std::atomic<std::uint64_t> dropped_others_{0};
};

}  // namespace sonard::server
