#include "server/recording/events.hpp"

namespace sonard::server {
namespace {

std::size_t payload(const GeminiPingServed& event) {
  const gemini::EncodedPing& ping = event.served.ping;
  return ping.shared_size() + static_cast<std::size_t>(ping.datagram_count()) * sizeof(std::uint32_t);
}
std::size_t payload(const GeminiStatusSent& event) {
  return event.datagram.size();
}
std::size_t payload(const MicronLineSent& event) {
  return event.line.bins.size();
}
std::size_t payload(const PingPosed& event) {
  return sizeof(PosesUsed) + event.poses->bodies.size() * sizeof(PosedBody);
}
std::size_t payload(const WirePassed& event) {
  std::size_t bytes = event.pieces.size() * sizeof(WirePiece);
  for (const WirePiece& piece : event.pieces) {
    bytes += piece.bytes.size();
  }
  return bytes;
}
std::size_t payload(const ClientLeft&) {
  return 0;
}

}  // namespace

std::size_t memory_of(const RecordingEvent& event) {
  return sizeof event + std::visit([](const auto& what) { return payload(what); }, event.what);
}

}  // namespace sonard::server
