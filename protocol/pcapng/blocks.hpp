// SPDX-License-Identifier: Apache-2.0
// Capture files of the form pcapng, which Wireshark and tcpdump read: IPv4 packets with their times.
// Source: draft-ietf-opsawg-pcapng, sections 3 and 4; link type 101 (IPv4 or IPv6 without more) by the list
// of link-layer header types of tcpdump.org. One section, little-endian, times in nanoseconds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/common/damage.hpp"
#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/pcapng/packets.hpp"

namespace sonard::pcapng {

inline constexpr std::uint16_t link_type_raw = 101;
inline constexpr std::size_t max_packet_size = 65'535;  ///< an IPv4 packet

/// Writes blocks to append to a file. A file is good after every whole block, so a killed program loses only
/// the one that was being written. Not thread-safe.
class Writer {
 public:
  /// @param application who writes, for those who look into a file: "sonard 0.1.0"
  explicit Writer(std::string_view application);

  /// @param name for example that of a head. @return the number of the interface. Names of 65535 bytes at
  /// most.
  std::uint32_t add_interface(std::string_view name);

  /// @param interface one that was added
  /// @param time_ns since the Unix epoch
  /// @param packet of at most max_packet_size bytes
  void add_packet(std::uint32_t interface, std::uint64_t time_ns, ByteView packet);

  /// The blocks to append to the file since the last call: whole ones, perhaps none.
  Bytes take();

 private:
  Bytes pending_;
  std::uint32_t interfaces_ = 0;
};

enum class BlockType : std::uint32_t {
  section_header = 0x0A0D0D0A,
  interface_description = 1,
  enhanced_packet = 6,
};

struct Block {
  std::uint32_t type = 0;  ///< may be none of BlockType
  std::size_t offset = 0;
  ByteView body;  ///< without type and lengths

  std::size_t end() const { return offset + body.size() + 12; }
};

/// The block at `offset`. @return nothing when the bytes end before it does; an error when its two lengths
/// disagree or can be no block's. Little-endian only.
Result<std::optional<Block>, WireError> block_at(ByteView bytes, std::size_t offset);

/// A packet as add_packet() took it.
struct Packet {
  std::uint32_t interface = 0;
  std::uint64_t time_ns = 0;
  ByteView bytes;  ///< not owned
};
/// Requires a block of type enhanced_packet.
Result<Packet, WireError> read_packet(const Block& block);

/// Calls `take` for each readable block. A block with two equal lengths is damaged if its type is not
/// registered, or if sonard wrote the section and never writes such a block. After a block with wrong
/// lengths, reading continues at the next block that has a known type and two equal lengths.
/// @return the parts that cannot be read; an error when no block of the file can be
Result<std::vector<Damage>, WireError> for_each_block(ByteView file,
                                                      const std::function<void(const Block&)>& take);

/// What is whole at the front of a file: truncate to `keep_size`, and it is good, and may be appended to.
struct Recovery {
  std::size_t keep_size = 0;
  std::uint64_t packets = 0;
  std::uint32_t interfaces = 0;
};
/// An error when the file does not begin with a section that sonard may have written.
Result<Recovery, WireError> recover(ByteView file);

}  // namespace sonard::pcapng
