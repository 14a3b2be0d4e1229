// SPDX-License-Identifier: Apache-2.0
#include "protocol/pcapng/blocks.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "protocol/common/byte_reader.hpp"
#include "protocol/common/byte_writer.hpp"

namespace sonard::pcapng {
namespace {

constexpr std::uint32_t byte_order_magic = 0x1A2B3C4D;
constexpr std::size_t block_overhead = 12;  // type, and the length twice
constexpr std::uint8_t nanoseconds = 9;     // resolution 10^-9 s

namespace options {
constexpr std::uint16_t end = 0;
constexpr std::uint16_t application = 4;  // of a section
constexpr std::uint16_t name = 2;         // of an interface
constexpr std::uint16_t resolution = 9;   // of the times of an interface
}  // namespace options

ByteView as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::size_t padding(std::size_t size) {
  return (4 - size % 4) % 4;
}

void write_padded(ByteWriter& writer, ByteView bytes) {
  writer.bytes(bytes);
  writer.zeros(padding(bytes.size()));
}

void write_option(ByteWriter& writer, std::uint16_t code, ByteView value) {
  writer.u16le(code);
  writer.u16le(static_cast<std::uint16_t>(value.size()));
  write_padded(writer, value);
}

void append_block(Bytes& out, BlockType type, ByteView body) {
  ByteWriter writer{out};
  const auto length = static_cast<std::uint32_t>(body.size() + block_overhead);
  writer.u32le(static_cast<std::uint32_t>(type));
  writer.u32le(length);
  writer.bytes(body);
  writer.u32le(length);
}

bool is(const Block& block, BlockType type) {
  return block.type == static_cast<std::uint32_t>(type);
}

bool is_known(const Block& block) {
  return is(block, BlockType::section_header) || is(block, BlockType::interface_description) ||
         (is(block, BlockType::enhanced_packet) && read_packet(block));
}

/// The value of the first option `code` of a block; nullopt if it is missing. @param skip bytes of the
/// body before its options
std::optional<std::string_view> option_of(const Block& block, std::size_t skip, std::uint16_t code) {
  ByteReader reader{block.body};
  reader.skip(skip, "body");
  while (reader.ok() && reader.remaining() > 0) {
    const std::uint16_t found = reader.u16le("option_code");
    const std::size_t size = reader.u16le("option_length");
    const ByteView value = reader.bytes(size, "option_value");
    reader.skip(padding(size), "option_value");
    if (reader.ok() && found == code) {
      return std::string_view{reinterpret_cast<const char*>(value.data()), value.size()};
    }
  }
  return std::nullopt;
}

/// Block types of draft-ietf-opsawg-pcapng, section 11.1. The highest bit marks types for local use.
bool is_registered(std::uint32_t type) {
  constexpr std::uint32_t local_use = 0x80000000;
  return (type & local_use) != 0 || (type >= 1 && type <= 0xA) || (type >= 0x101 && type <= 0x102) ||
         (type >= 0x201 && type <= 0x221) || type == 0xBAD || type == 0x40000BAD || type == 0x0A0D0D0A;
}

/// True if the body is exactly the body of a packet block, so that only the type can be wrong.
bool holds_packet(const Block& block) {
  constexpr std::size_t front = 20;
  const auto packet = read_packet(block);
  return packet && !packet->bytes.empty() &&
         block.body.size() == front + packet->bytes.size() + padding(packet->bytes.size());
}

/// Detects damaged blocks with correct lengths by their content.
class BlockCheck {
 public:
  /// Checks one block. Call for all blocks of a file, in order.
  std::optional<WireError> error_in(const Block& block) {
    switch (static_cast<BlockType>(block.type)) {
      case BlockType::section_header:
        return error_in_section(block);
      case BlockType::interface_description:
        return error_in_interface(block);
      case BlockType::enhanced_packet:
        return error_in_packet(block);
    }
    const bool damaged = ours_ || !is_registered(block.type) || holds_packet(block);
    return damaged ? std::optional(WireError{WireErrorReason::bad_value, block.offset, "block_type"})
                   : std::nullopt;
  }

 private:
  std::optional<WireError> error_in_section(const Block& block) {
    constexpr std::size_t front = 16;
    if (ByteReader{block.body}.u32le("magic") != byte_order_magic) {
      return WireError{WireErrorReason::bad_value, block.offset + 8, "byte_order_magic"};
    }
    ours_ = option_of(block, front, options::application).value_or("").starts_with("sonard ");
    return std::nullopt;
  }

  std::optional<WireError> error_in_interface(const Block& block) const {
    return ours_ && ByteReader{block.body}.u16le("link_type") != link_type_raw
               ? std::optional(WireError{WireErrorReason::bad_value, block.offset + 8, "link_type"})
               : std::nullopt;
  }

  std::optional<WireError> error_in_packet(const Block& block) const {
    const auto packet = read_packet(block);
    if (!packet) {
      return packet.error();
    }
    const bool is_ipv4 = !packet->bytes.empty() && packet->bytes[0] >> 4 == 4;
    return ours_ && !is_ipv4
               ? std::optional(WireError{WireErrorReason::bad_value, block.offset + 28, "ip_version"})
               : std::nullopt;
  }

  /// sonard wrote the section, so it has only BlockType blocks, raw links and IPv4 packets.
  bool ours_ = false;
};

/// Offset of the next block of a known type after `offset`. Blocks begin at multiples of four bytes,
/// but not after bytes that are missing or too many.
std::optional<std::size_t> next_block(ByteView file, std::size_t offset) {
  for (std::size_t at = offset + 1; at < file.size(); ++at) {
    const auto block = block_at(file, at);
    if (block && *block && is_known(**block)) {
      return at;
    }
  }
  return std::nullopt;
}

}  // namespace

Writer::Writer(std::string_view application) {
  Bytes body;
  ByteWriter writer{body};
  writer.u32le(byte_order_magic);
  writer.u16le(1);  // version
  writer.u16le(0);
  writer.u64le(UINT64_MAX);  // length of the section: not specified
  write_option(writer, options::application, as_bytes(application));
  write_option(writer, options::end, {});
  append_block(pending_, BlockType::section_header, body);
}

std::uint32_t Writer::add_interface(std::string_view name) {
  Bytes body;
  ByteWriter writer{body};
  writer.u16le(link_type_raw);
  writer.u16le(0);
  writer.u32le(0);  // no limit on the size of a packet
  write_option(writer, options::name, as_bytes(name));
  write_option(writer, options::resolution, std::span{&nanoseconds, 1});
  write_option(writer, options::end, {});
  append_block(pending_, BlockType::interface_description, body);
  return interfaces_++;
}

void Writer::add_packet(std::uint32_t interface, std::uint64_t time_ns, ByteView packet) {
  assert(interface < interfaces_ && packet.size() <= max_packet_size);
  Bytes body;
  body.reserve(20 + packet.size() + padding(packet.size()));
  ByteWriter writer{body};
  writer.u32le(interface);
  writer.u32le(static_cast<std::uint32_t>(time_ns >> 32));  // high word first
  writer.u32le(static_cast<std::uint32_t>(time_ns));
  writer.u32le(static_cast<std::uint32_t>(packet.size()));  // captured
  writer.u32le(static_cast<std::uint32_t>(packet.size()));  // on the wire
  write_padded(writer, packet);
  append_block(pending_, BlockType::enhanced_packet, body);
}

Bytes Writer::take() {
  return std::exchange(pending_, {});
}

Result<std::optional<Block>, WireError> block_at(ByteView bytes, std::size_t offset) {
  const auto nothing = std::optional<Block>{};
  if (offset >= bytes.size()) {
    return nothing;
  }
  ByteReader reader{bytes.subspan(offset)};
  const std::uint32_t type = reader.u32le("block_type");
  const std::size_t length = reader.u32le("block_length");
  if (!reader.ok()) {
    return nothing;
  }
  if (length < block_overhead || length % 4 != 0) {
    return WireError{WireErrorReason::bad_length, offset + 4, "block_length"};
  }
  const ByteView body = reader.bytes(length - block_overhead, "body");
  const std::size_t repeated = reader.u32le("block_length");
  if (!reader.ok()) {
    return nothing;
  }
  if (repeated != length) {
    return WireError{WireErrorReason::bad_length, offset + length - 4, "block_length"};
  }
  return std::optional{Block{type, offset, body}};
}

Result<Packet, WireError> read_packet(const Block& block) {
  ByteReader reader{block.body};
  Packet packet;
  packet.interface = reader.u32le("interface");
  packet.time_ns = std::uint64_t{reader.u32le("time")} << 32;
  packet.time_ns |= reader.u32le("time");
  const std::size_t size = reader.u32le("captured_size");
  reader.skip(4, "original_size");
  packet.bytes = reader.bytes(size, "packet");
  if (!reader.ok()) {
    WireError error = *reader.error();
    error.offset += block.offset + 8;
    return error;
  }
  return packet;
}

Result<std::vector<Damage>, WireError> for_each_block(ByteView file,
                                                      const std::function<void(const Block&)>& take) {
  std::vector<Damage> damaged;
  BlockCheck check;
  bool found = false;
  for (std::size_t offset = 0; offset < file.size();) {
    const auto block = block_at(file, offset);
    const bool whole = block && *block;
    const auto error = whole    ? check.error_in(**block)
                       : !block ? std::optional(block.error())
                                : WireError{WireErrorReason::truncated, offset, "block"};
    const std::size_t next = whole ? (*block)->end() : next_block(file, offset).value_or(file.size());
    if (error) {
      damaged.push_back({offset, next - offset, *error});
    } else {
      found = true;
      take(**block);
    }
    offset = next;
  }
  if (!found) {
    return damaged.empty() ? WireError{WireErrorReason::truncated, 0, "section_header"} : damaged[0].error;
  }
  return damaged;
}

bool begins_with_section(ByteView file) {
  const auto first = block_at(file, 0);
  return first && *first && is(**first, BlockType::section_header) &&
         ByteReader{(*first)->body}.u32le("magic") == byte_order_magic;
}

Result<Recovery, WireError> recover(ByteView file) {
  const auto first = block_at(file, 0);
  if (!first) {
    return first.error();
  }
  if (!*first) {
    return WireError{WireErrorReason::truncated, file.size(), "section_header"};
  }
  if (!begins_with_section(file)) {
    return WireError{WireErrorReason::bad_value, 0, "section_header"};
  }
  Recovery recovery{.keep_size = (*first)->end()};
  while (true) {
    const auto block = block_at(file, recovery.keep_size);
    if (!block || !*block) {
      return recovery;
    }
    if (is(**block, BlockType::enhanced_packet)) {
      const auto packet = read_packet(**block);
      if (!packet || packet->interface >= recovery.interfaces) {
        return recovery;
      }
      ++recovery.packets;
    } else if (is(**block, BlockType::interface_description)) {
      ++recovery.interfaces;
    }
    recovery.keep_size = (*block)->end();
  }
}

}  // namespace sonard::pcapng
