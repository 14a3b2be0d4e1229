// SPDX-License-Identifier: Apache-2.0
// A head's picture for Foxglove, drawn once for all viewers.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "server/picture/ping_picture.hpp"
#include "server/web/site.hpp"

namespace sonard::server {

/// Belongs to the thread of the page, except draw().
class HeadPicture {
 public:
  /// Whether the caller must draw() and then call drawn(): there is a newer ping, the last drawing began at
  /// least `interval` ago, and none is under way.
  bool begin(const std::shared_ptr<const ShownPing>& newest, TimePoint now,
             std::chrono::nanoseconds interval);
  /// The picture as text of a foxglove.CompressedImage; null if there is none yet. Drawing thread.
  /// @param pings of the head, the newest last; not empty
  Text draw(const Pings& pings, const std::string& head);
  /// @param picture null: there is none
  void drawn(Text picture);
  /// The newest picture that is drawn; null: none.
  const Text& text() const { return text_; }

 private:
  PingPicture picture_;                     ///< belongs to draw()
  std::shared_ptr<const ShownPing> begun_;  ///< the ping of the last drawing
  TimePoint begun_at_{};
  bool under_way_ = false;
  Text text_;
};

}  // namespace sonard::server
