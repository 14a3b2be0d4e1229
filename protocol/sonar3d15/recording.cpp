// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/recording.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "protocol/sonar3d15/packet.hpp"

namespace sonard::sonar3d15 {
namespace {

using ByteView = std::span<const std::uint8_t>;

/// Bytes until the next possible packet, at least 1.
std::size_t to_next_id(ByteView bytes) {
  constexpr std::array<std::uint8_t, 3> start{'R', 'I', 'P'};
  const auto found = std::search(bytes.begin() + 1, bytes.end(), start.begin(), start.end());
  return static_cast<std::size_t>(found - bytes.begin());
}

}  // namespace

std::vector<Damage> for_each_packet(ByteView file, const std::function<void(ByteView)>& take) {
  std::vector<Damage> damages;
  std::optional<Damage> damage;  // not ended yet
  std::size_t offset = 0;
  const auto end_damage = [&] {
    if (damage) {
      damage->size = offset - damage->offset;
      damages.push_back(*damage);
      damage.reset();
    }
  };
  while (offset < file.size()) {
    const ByteView rest = file.subspan(offset);
    const auto packet = front_packet(rest);
    if (packet) {
      end_damage();
      take(*packet);
      offset += packet->size();
      continue;
    }
    if (!damage) {
      WireError error = packet.error();
      error.offset += offset;
      damage = Damage{offset, 0, error};
    }
    offset += to_next_id(rest);
  }
  end_damage();
  return damages;
}

}  // namespace sonard::sonar3d15
