// SPDX-License-Identifier: Apache-2.0
// A head's interface to the recorder. Without a recorder it does nothing.
#pragma once

#include <memory>
#include <utility>

#include "server/clock/clock.hpp"
#include "server/recording/events.hpp"
#include "server/recording/recorder.hpp"

namespace sonard::server {

/// Belongs to the I/O thread. Never blocks.
class HeadRecording {
 public:
  /// @param recorder null: nothing is recorded; otherwise it must outlive this object
  /// @param head index in the configuration
  HeadRecording(Recorder* recorder, int head, const Clock& clock)
      : recorder_(recorder), head_(head), clock_(&clock) {}

  bool on() const { return recorder_ != nullptr; }

  void wire(WirePassed passed) const { push(std::move(passed)); }
  void stream_ended(const WireEnds& ends) const { push(StreamEnded{ends}); }
  /// A status message was sent to all clients; recorded only if the head's logs store it.
  void status(const SharedBytes& message) const {
    if (on() && recorder_->stores_statuses(head_)) {
      push(StatusSent{message});
    }
  }
  void ping(PingSent ping) const { push(std::move(ping)); }
  void posed(const std::shared_ptr<const PosesUsed>& poses) const { push(PingPosed{poses}); }

 private:
  template <class What>
  void push(What what) const {
    if (on()) {
      recorder_->push({head_, clock_->now(), std::move(what)});
    }
  }

  Recorder* recorder_;
  int head_;
  const Clock* clock_;
};

}  // namespace sonard::server
