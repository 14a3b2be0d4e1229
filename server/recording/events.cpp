// SPDX-License-Identifier: Apache-2.0
#include "server/recording/events.hpp"

namespace sonard::server {
namespace {

std::size_t payload(const PingSent& event) {
  const PingRecord& ping = event.ping;
  return ping.samples.size() + ping.wire.size() + ping.bearings_rad.size() * sizeof(double) +
         (ping.points ? ping.points->size() * sizeof(EchoPoint) : 0);
}
std::size_t payload(const StatusSent& event) {
  return event.message.size();
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
std::size_t payload(const StreamEnded&) {
  return 0;
}

}  // namespace

std::size_t memory_of(const RecordingEvent& event) {
  return sizeof event + std::visit([](const auto& what) { return payload(what); }, event.what);
}

}  // namespace sonard::server
