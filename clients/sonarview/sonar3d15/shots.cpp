// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/sonar3d15/shots.hpp"

#include <utility>
#include <variant>

namespace sonard::client {

void Shots::receive(TimePoint at, std::span<const std::uint8_t> datagram) {
  ++statistics_.packets;
  const auto message = sonar3d15::decode(datagram);
  if (!message) {
    ++statistics_.bad_packets;
  } else if (const auto* const range = std::get_if<sonar3d15::RangeImage>(&*message)) {
    range_ = *range;
  } else if (const auto* const signal = std::get_if<sonar3d15::BitmapImageGreyscale8>(&*message)) {
    if (signal->type() == waterlinked::sonar::protocol::SIGNAL_STRENGTH_IMAGE) {
      pair(at, *signal);
    }
  }
}

void Shots::pair(TimePoint at, const sonar3d15::BitmapImageGreyscale8& signal) {
  const std::uint32_t number = signal.header().sequence_id();
  if (!range_ || range_->header().sequence_id() != number || range_->width() != signal.width() ||
      range_->height() != signal.height() || signal.width() < 2 || signal.height() < 2) {
    ++statistics_.unpaired;
    return;
  }
  if (newest_) {
    const std::uint32_t step = number - *newest_;
    statistics_.shots_missed += step > 1 && step < 1000 ? step - 1 : 0;
  }
  newest_ = number;
  shots_.push_back({std::move(*range_), signal, at});
  range_.reset();
}

std::vector<ReceivedShot> Shots::take() {
  return std::exchange(shots_, {});
}

}  // namespace sonard::client
