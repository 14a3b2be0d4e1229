// SPDX-License-Identifier: Apache-2.0
#include "protocol/pcapng/packets.hpp"

#include <algorithm>
#include <cassert>

namespace sonard::pcapng {
namespace {

constexpr std::size_t ip_header_size = 20;
constexpr std::size_t udp_header_size = 8;
constexpr std::size_t tcp_header_size = 20;
constexpr std::size_t max_segment = 1460;  // of Ethernet
constexpr std::uint8_t protocol_tcp = 6;
constexpr std::uint8_t protocol_udp = 17;

namespace tcp_flags {
constexpr std::uint8_t fin = 0x01;
constexpr std::uint8_t syn = 0x02;
constexpr std::uint8_t push = 0x08;
constexpr std::uint8_t ack = 0x10;
}  // namespace tcp_flags

/// Appends in network byte order.
void write_be(Bytes& out, std::uint64_t value, std::size_t width) {
  for (std::size_t i = width; i-- > 0;) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

void store_be16(Bytes& bytes, std::size_t offset, std::uint16_t value) {
  bytes[offset] = static_cast<std::uint8_t>(value >> 8);
  bytes[offset + 1] = static_cast<std::uint8_t>(value);
}

/// Sum of 16-bit words, not folded; an odd byte at the end is padded with zero (RFC 1071).
std::uint64_t sum_words(ByteView bytes) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    sum += i % 2 == 0 ? std::uint64_t{bytes[i]} << 8 : bytes[i];
  }
  return sum;
}

std::uint16_t folded_complement(std::uint64_t sum) {
  while (sum > 0xFFFF) {
    sum = (sum & 0xFFFF) + (sum >> 16);
  }
  return static_cast<std::uint16_t>(~sum);
}

/// An IPv4 header with its checksum, for `size` bytes after it.
Bytes ip_header(const Endpoint& from, const Endpoint& to, std::uint8_t protocol, std::size_t size) {
  Bytes packet;
  packet.reserve(ip_header_size + size);
  write_be(packet, 0x4500, 2);  // version 4, 5 words of header
  write_be(packet, ip_header_size + size, 2);
  write_be(packet, 0, 2);       // identification: not needed without fragments (RFC 6864)
  write_be(packet, 0x4000, 2);  // do not fragment
  write_be(packet, 64, 1);      // time to live
  write_be(packet, protocol, 1);
  write_be(packet, 0, 2);  // checksum
  write_be(packet, from.address, 4);
  write_be(packet, to.address, 4);
  store_be16(packet, 10, folded_complement(sum_words(packet)));
  return packet;
}

/// The checksum of UDP and TCP: over the bytes after the IPv4 header, addresses, protocol and length.
std::uint16_t transport_checksum(ByteView packet, std::uint8_t protocol,
                                 std::size_t header_size = ip_header_size) {
  return folded_complement(sum_words(packet.subspan(12, 8)) + protocol + packet.size() - header_size +
                           sum_words(packet.subspan(header_size)));
}

Bytes tcp_packet(const Endpoint& from, const Endpoint& to, std::uint32_t sequence, std::uint32_t acknowledged,
                 std::uint8_t flags, ByteView payload) {
  Bytes packet = ip_header(from, to, protocol_tcp, tcp_header_size + payload.size());
  write_be(packet, from.port, 2);
  write_be(packet, to.port, 2);
  write_be(packet, sequence, 4);
  write_be(packet, acknowledged, 4);
  write_be(packet, 0x50, 1);  // 5 words of header
  write_be(packet, flags, 1);
  write_be(packet, 0xFFFF, 2);  // window
  write_be(packet, 0, 2);       // checksum
  write_be(packet, 0, 2);       // urgent pointer
  packet.insert(packet.end(), payload.begin(), payload.end());
  store_be16(packet, ip_header_size + 16, transport_checksum(packet, protocol_tcp));
  return packet;
}

}  // namespace

bool has_right_checksums(ByteView packet) {
  if (packet.empty() || packet[0] >> 4 != 4) {
    return true;
  }
  if (packet.size() < ip_header_size) {
    return false;
  }
  const std::size_t header_size = (packet[0] & 0xFU) * 4U;
  const std::size_t size = std::size_t{packet[2]} << 8 | packet[3];
  if (header_size < ip_header_size || size < header_size || size > packet.size()) {
    return false;
  }
  // The sum over bytes with their own checksum is zero.
  if (folded_complement(sum_words(packet.first(header_size))) != 0) {
    return false;
  }
  const ByteView whole = packet.first(size);
  const ByteView content = whole.subspan(header_size);
  const std::uint8_t protocol = packet[9];
  const bool none =
      protocol == protocol_udp && content.size() >= udp_header_size && content[6] == 0 && content[7] == 0;
  return (protocol != protocol_udp && protocol != protocol_tcp) || none ||
         transport_checksum(whole, protocol, header_size) == 0;
}

Bytes udp_packet(const Endpoint& from, const Endpoint& to, ByteView payload) {
  assert(payload.size() <= max_udp_payload);
  Bytes packet = ip_header(from, to, protocol_udp, udp_header_size + payload.size());
  write_be(packet, from.port, 2);
  write_be(packet, to.port, 2);
  write_be(packet, udp_header_size + payload.size(), 2);
  write_be(packet, 0, 2);  // checksum
  packet.insert(packet.end(), payload.begin(), payload.end());
  const std::uint16_t checksum = transport_checksum(packet, protocol_udp);
  // Zero would mean that there is no checksum (RFC 768).
  store_be16(packet, ip_header_size + 6, checksum == 0 ? std::uint16_t{0xFFFF} : checksum);
  return packet;
}

TcpConversation::TcpConversation(const Endpoint& client, const Endpoint& server)
    : client_{client}, server_{server} {}

std::vector<Bytes> TcpConversation::open() {
  const Bytes syn =
      tcp_packet(client_.endpoint, server_.endpoint, client_.next_sequence++, 0, tcp_flags::syn, {});
  const Bytes answer = tcp_packet(server_.endpoint, client_.endpoint, server_.next_sequence++,
                                  client_.next_sequence, tcp_flags::syn | tcp_flags::ack, {});
  const Bytes ack = tcp_packet(client_.endpoint, server_.endpoint, client_.next_sequence,
                               server_.next_sequence, tcp_flags::ack, {});
  return {syn, answer, ack};
}

std::vector<Bytes> TcpConversation::from_client(ByteView bytes) {
  return segments(client_, server_, bytes);
}

std::vector<Bytes> TcpConversation::from_server(ByteView bytes) {
  return segments(server_, client_, bytes);
}

std::vector<Bytes> TcpConversation::close() {
  const auto fin_ack = [](Side& from, const Side& to) {
    return tcp_packet(from.endpoint, to.endpoint, from.next_sequence++, to.next_sequence,
                      tcp_flags::fin | tcp_flags::ack, {});
  };
  const Bytes first = fin_ack(client_, server_);
  const Bytes second = fin_ack(server_, client_);
  const Bytes ack = tcp_packet(client_.endpoint, server_.endpoint, client_.next_sequence,
                               server_.next_sequence, tcp_flags::ack, {});
  return {first, second, ack};
}

std::vector<Bytes> TcpConversation::segments(Side& from, const Side& to, ByteView bytes) {
  std::vector<Bytes> packets;
  while (!bytes.empty()) {
    const ByteView piece = bytes.first(std::min(bytes.size(), max_segment));
    packets.push_back(tcp_packet(from.endpoint, to.endpoint, from.next_sequence, to.next_sequence,
                                 tcp_flags::push | tcp_flags::ack, piece));
    from.next_sequence += static_cast<std::uint32_t>(piece.size());
    bytes = bytes.subspan(piece.size());
  }
  return packets;
}

}  // namespace sonard::pcapng
