// SPDX-License-Identifier: Apache-2.0
// Capture files in pcapng format, for Wireshark and tcpdump: IPv4 packets with times.
// Source: draft-ietf-opsawg-pcapng, sections 3 and 4; link type 101 (raw IPv4 or IPv6) from the list of
// link-layer header types of tcpdump.org. One section, little-endian, times in nanoseconds.
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
inline constexpr std::size_t max_packet_size = 65'535;  ///< limit of an IPv4 packet

/// Makes blocks to append to a file. A file is valid after every whole block, so a killed program loses only
/// the block in progress. Not thread-safe.
class Writer {
 public:
  /// @param application name of the writing program, for readers of the file: "sonard 0.1.0"
  explicit Writer(std::string_view application);

  /// @param name for example the name of a head, at most 65535 bytes. @return the number of the interface
  std::uint32_t add_interface(std::string_view name);

  /// @param interface number of an added interface
  /// @param time_ns nanoseconds since the Unix epoch
  /// @param packet at most max_packet_size bytes
  void add_packet(std::uint32_t interface, std::uint64_t time_ns, ByteView packet);

  /// The whole blocks since the last call, to append to the file; may be empty.
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
  std::uint32_t type = 0;  ///< BlockType or another value
  std::size_t offset = 0;
  ByteView body;  ///< without type and lengths

  std::size_t end() const { return offset + body.size() + 12; }
};

/// The block at `offset`. @return nullopt if the bytes end before the block does; an error if its two lengths
/// differ or are invalid. Little-endian only.
Result<std::optional<Block>, WireError> block_at(ByteView bytes, std::size_t offset);

/// A packet as given to add_packet().
struct Packet {
  std::uint32_t interface = 0;
  std::uint64_t time_ns = 0;
  ByteView bytes;  ///< not owned
};
/// Reads a packet from a block, which must have type enhanced_packet.
Result<Packet, WireError> read_packet(const Block& block);

/// Calls `take` for each readable block. A block with two equal lengths is damaged if its type is not
/// registered, or if sonard wrote the section and never writes such a block. After a block with wrong
/// lengths, reading continues at the next block that has a known type and two equal lengths.
/// @return the unreadable parts; an error if no block is readable
Result<std::vector<Damage>, WireError> for_each_block(ByteView file,
                                                      const std::function<void(const Block&)>& take);

/// True if the file begins with a whole header of a section as sonard writes it.
bool begins_with_section(ByteView file);

/// The whole blocks at the front of a file. Truncate it to `keep_size` to make it valid; then blocks may be
/// appended.
struct Recovery {
  std::size_t keep_size = 0;
  std::uint64_t packets = 0;
  std::uint32_t interfaces = 0;
};
/// Finds the whole part of a file; an error if the file does not begin with a section as sonard writes it.
Result<Recovery, WireError> recover(ByteView file);

}  // namespace sonard::pcapng
