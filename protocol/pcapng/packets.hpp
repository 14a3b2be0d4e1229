// SPDX-License-Identifier: Apache-2.0
// Wraps bytes of a socket or serial line in IPv4 packets, so that a capture looks as if taken from a cable.
// Headers and checksums follow RFC 791, RFC 768 and RFC 9293; no options, no fragments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sonard::pcapng {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

struct Endpoint {
  std::uint32_t address = 0;  ///< IPv4, first octet most significant
  std::uint16_t port = 0;

  bool operator==(const Endpoint&) const = default;
};

/// Maximum payload of a UDP datagram over IPv4.
inline constexpr std::size_t max_udp_payload = 65'507;

/// One datagram as an IPv4 packet. Requires a payload of at most max_udp_payload bytes.
Bytes udp_packet(const Endpoint& from, const Endpoint& to, ByteView payload);

/// False if the IPv4 packet is cut or if a checksum is wrong: of its header (RFC 791), or of the UDP or TCP
/// inside. A UDP checksum of 0 means that there is no checksum (RFC 768). Other packets are not checked.
bool has_right_checksums(ByteView packet);

/// Converts the bytes between two ends to packets of one complete TCP connection. Only the bytes on the
/// socket are known, not the packets on the cable. So sequence numbers begin at 0, nothing is sent twice,
/// every segment acknowledges all bytes before it, and long parts become segments of 1460 bytes. Readers such
/// as Wireshark reassemble an equal stream.
///
/// Serial lines and pseudo terminals are also recorded as TCP connections, between two documentation
/// addresses of RFC 5737. A link type for private use would need a setting in every Wireshark, and Wireshark
/// would not reassemble frames that were read in parts.
class TcpConversation {
 public:
  TcpConversation(const Endpoint& client, const Endpoint& server);

  /// The three packets that begin the connection.
  std::vector<Bytes> open();
  std::vector<Bytes> from_client(ByteView bytes);
  std::vector<Bytes> from_server(ByteView bytes);
  /// The three packets that end the connection, the client's first.
  std::vector<Bytes> close();

 private:
  struct Side {
    Endpoint endpoint;
    std::uint32_t next_sequence = 0;
  };

  static std::vector<Bytes> segments(Side& from, const Side& to, ByteView bytes);

  Side client_;
  Side server_;
};

/// The ends of a serial line (192.0.2.2 and 192.0.2.1). Port 4001 is common for serial device servers, and
/// the dissector of the Micron uses it.
inline constexpr Endpoint serial_client{0xC0'00'02'02, 49'152};
inline constexpr Endpoint serial_head{0xC0'00'02'01, 4001};

}  // namespace sonard::pcapng
