// SPDX-License-Identifier: Apache-2.0
// Any bytes as a recording of a Sonar 3D-15, as its message in a packet, and as a block of Snappy in a
// packet: the first byte chooses. Promises: packets and damage together are the whole file; a message that is
// read can be written and read again.
#include <zlib.h>

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "protocol/sonar3d15/codec.hpp"
#include "protocol/sonar3d15/recording.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace sonard::sonar3d15;
using sonard::fuzz::require;
using ByteView = std::span<const std::uint8_t>;

void read_message(ByteView packet) {
  const auto message = decode(packet);
  if (!message) {
    require(message.error().offset <= packet.size(), "an error lies inside the packet");
    return;
  }
  std::visit(
      []<class Known>(const Known& known) {
        if constexpr (!std::is_same_v<Known, Unknown>) {
          const auto again = decode(encode(known, PacketId::rip1));
          const bool too_long = known.ByteSizeLong() > most_packet_size - 200;
          require(
              too_long || (again && std::get<Known>(*again).SerializeAsString() == known.SerializeAsString()),
              "a message is written as it was read");
        }
      },
      *message);
}

void read_file(ByteView file) {
  std::size_t taken = 0;
  for (const sonard::Damage& damage : for_each_packet(file, [&](ByteView packet) {
         taken += packet.size();
         read_message(packet);
       })) {
    require(damage.size > 0 && damage.offset + damage.size <= file.size(), "damage lies in the file");
    require(damage.error.offset >= damage.offset && damage.error.offset <= file.size(), "so does its error");
    taken += damage.size;
  }
  require(taken == file.size(), "every byte is a packet's or damaged");
}

/// The packet with this payload as a block of Snappy.
std::vector<std::uint8_t> with_block(ByteView block) {
  std::vector<std::uint8_t> packet = pack(block, PacketId::rip1);
  packet.resize(packet.size() - checksum_size);
  packet[3] = '2';
  const auto crc = static_cast<std::uint32_t>(crc32_z(0, packet.data(), packet.size()));
  for (int byte = 0; byte < 4; ++byte) {
    packet.push_back(static_cast<std::uint8_t>(crc >> (8 * byte)));
  }
  return packet;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const ByteView rest{data + 1, size - 1};
  switch (data[0] % 3) {
    case 0:
      read_file(rest);
      break;
    case 1:
      read_message(pack(rest, PacketId::rip1));
      break;
    default:
      read_message(with_block(rest));
  }
  return 0;
}
