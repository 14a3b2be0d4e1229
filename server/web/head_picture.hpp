// SPDX-License-Identifier: Apache-2.0
// A head's picture for Foxglove, drawn once for all viewers.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "server/picture/ping_picture.hpp"
#include "server/web/site.hpp"

namespace sonard::server {

/// Belongs to the thread of the page.
class HeadPicture {
 public:
  /// The newest picture as text of a foxglove.CompressedImage; null if there is none yet. Draws only if there
  /// is a newer ping and the last picture is older than `interval`: viewers who ask meanwhile share it.
  /// @param pings of the head, the newest last; not empty
  std::shared_ptr<const std::string> newest(const Pings& pings, const std::string& head, TimePoint now,
                                            std::chrono::nanoseconds interval);

 private:
  PingPicture picture_;
  std::shared_ptr<const ShownPing> drawn_;  ///< the ping of text_
  TimePoint drawn_at_{};
  std::shared_ptr<const std::string> text_;
};

}  // namespace sonard::server
