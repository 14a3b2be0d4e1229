// SPDX-License-Identifier: Apache-2.0
// The queue from the serving threads to the recorder. It never blocks the serving threads.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <semaphore>
#include <vector>

#include "server/recording/events.hpp"

namespace sonard::server {

/// Counts of events dropped because the queue was full, by content. They only grow.
struct DroppedEvents {
  std::uint64_t images = 0;  ///< pings and scan lines
  std::uint64_t pieces = 0;  ///< datagrams and reads or writes of streams
  std::uint64_t others = 0;  ///< statuses, poses, ends of streams

  std::uint64_t total() const { return images + pieces + others; }
};

/// Bounded by bytes, for any number of pushing threads and one taking thread. push() takes no lock and makes
/// no system call except the wake-up, so the taking thread, whatever its priority, cannot block a pushing
/// one. Events are pushed onto a linked stack by compare-and-swap, and take() swaps out the whole stack.
class EventQueue {
 public:
  explicit EventQueue(std::size_t most_bytes) : most_bytes_(most_bytes) {}
  ~EventQueue();
  EventQueue(const EventQueue&) = delete;
  EventQueue& operator=(const EventQueue&) = delete;

  /// @return false if the event does not fit; it is then dropped and counted.
  bool push(RecordingEvent event);
  /// Wakes the taker without an event.
  void wake() { news_.release(); }

  /// Waits until push() or wake() was called, or the time is over.
  void wait(std::chrono::milliseconds longest) { static_cast<void>(news_.try_acquire_for(longest)); }
  /// Takes all events in the order of push(). Their memory counts until done().
  std::vector<RecordingEvent> take();
  /// Releases the counted memory of a processed event.
  void done(const RecordingEvent& event);

  /// Memory of the events that are not done, in bytes. Any thread.
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
