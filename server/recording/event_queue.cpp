// SPDX-License-Identifier: Apache-2.0
#include "server/recording/event_queue.hpp"

#include <algorithm>
#include <memory>
#include <utility>

namespace sonard::server {

EventQueue::~EventQueue() {
  take();
}

bool EventQueue::push(RecordingEvent event) {
  const std::size_t size = memory_of(event);
  if (bytes_.fetch_add(size) + size > most_bytes_) {
    bytes_.fetch_sub(size);
    count_dropped(event);
    return false;
  }
  // The stack owns the node from the exchange on. Only take() removes nodes, and it removes all at once, so
  // the node that `next` points to cannot be reused (no ABA). After the exchange the taker may delete the
  // node, so it is not accessed again.
  Node* before = newest_.load(std::memory_order_relaxed);
  Node* const node = new Node{std::move(event), before};
  while (!newest_.compare_exchange_weak(before, node, std::memory_order_release, std::memory_order_relaxed)) {
    node->next = before;
  }
  if (before == nullptr) {  // the thread that finds the stack empty wakes the taker: once per take()
    news_.release();
  }
  return true;
}

std::vector<RecordingEvent> EventQueue::take() {
  std::vector<RecordingEvent> events;
  std::unique_ptr<Node> node(newest_.exchange(nullptr, std::memory_order_acquire));
  while (node) {
    events.push_back(std::move(node->event));
    node.reset(node->next);
  }
  std::ranges::reverse(events);
  return events;
}

void EventQueue::done(const RecordingEvent& event) {
  bytes_.fetch_sub(memory_of(event));
}

void EventQueue::count_dropped(const RecordingEvent& event) {
  if (const auto* wire = std::get_if<WirePassed>(&event.what)) {
    dropped_pieces_ += wire->pieces.size();
  } else if (std::holds_alternative<PingSent>(event.what)) {
    ++dropped_images_;
  } else {
    ++dropped_others_;
  }
}

DroppedEvents EventQueue::dropped() const {
  return {dropped_images_, dropped_pieces_, dropped_others_};
}

}  // namespace sonard::server
