// SPDX-License-Identifier: Apache-2.0
// Draws a head's picture for Foxglove, once for all viewers.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "server/picture/ping_picture.hpp"
#include "server/web/site.hpp"

namespace sonard::server {

/// Belongs to the page's thread, except draw().
class HeadPicture {
 public:
  /// True if the caller must call draw() and then drawn(): there is a newer ping, the last drawing began at
  /// least `interval` ago, and no drawing is in progress.
  bool begin(const std::shared_ptr<const ShownPing>& newest, TimePoint now,
             std::chrono::nanoseconds interval);
  /// The picture as the text of a foxglove.CompressedImage; null before the first one. Drawing thread.
  /// @param pings of the head, the newest last; not empty
  Text draw(const Pings& pings, const std::string& head);
  /// @param picture null: no picture
  void drawn(Text picture);
  /// The newest finished picture; null: no picture.
  const Text& text() const { return text_; }

 private:
  PingPicture picture_;                     ///< belongs to draw()
  std::shared_ptr<const ShownPing> begun_;  ///< the ping of the last drawing
  TimePoint begun_at_{};
  bool under_way_ = false;
  Text text_;
};

}  // namespace sonard::server
