// SPDX-License-Identifier: Apache-2.0
// IPv4 packets around what was said on a socket or a serial line, so that a capture of it looks as if it had
// been taken from a cable. Headers and checksums as RFC 791, RFC 768 and RFC 9293 say; no options, no
// fragments.
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

/// The most that one UDP datagram over IPv4 carries.
inline constexpr std::size_t max_udp_payload = 65'507;

/// One datagram as an IPv4 packet. Requires a payload of at most max_udp_payload: no more arrives in one.
Bytes udp_packet(const Endpoint& from, const Endpoint& to, ByteView payload);

/// True unless the IPv4 packet is cut or one of its checksums is wrong: of its header (RFC 791), or of UDP or
/// TCP inside. A UDP checksum of 0 is none (RFC 768). Packets of other kinds are not checked.
bool has_right_checksums(ByteView packet);

/// Bytes that passed both ways between two ends, as segments of one TCP connection from its first packet to
/// its last. What was said on the socket is known, not what went over the cable: sequence numbers begin at 0,
/// nothing is sent twice, every segment acknowledges all that came before it, and long pieces become segments
/// of 1460 bytes. A reader of the capture, Wireshark say, puts the same stream together from them.
///
/// A serial line or pseudo terminal is written down as such a connection too, between two addresses that RFC
/// 5737 keeps for documentation. The link type that Wireshark has for private use would need a setting in
/// every Wireshark, and would not put frames together that were read in pieces.
class TcpConversation {
 public:
  TcpConversation(const Endpoint& client, const Endpoint& server);

  /// The three packets that begin it.
  std::vector<Bytes> open();
  std::vector<Bytes> from_client(ByteView bytes);
  std::vector<Bytes> from_server(ByteView bytes);
  /// The three packets that end it, the client first.
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

/// The ends of a serial line (192.0.2.2 and 192.0.2.1). Port 4001 is where device servers commonly offer one,
/// and where the dissector of the Micron looks.
inline constexpr Endpoint serial_client{0xC0'00'02'02, 49'152};
inline constexpr Endpoint serial_head{0xC0'00'02'01, 4001};

}  // namespace sonard::pcapng
