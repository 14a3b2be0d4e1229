// What heads say, on its way from the thread where it was said to the thread that writes it down.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "protocol/gemini/encoded_ping.hpp"
#include "protocol/gemini/shared_bytes.hpp"
#include "protocol/micron/micron_job.hpp"
#include "renderer/pose.hpp"
#include "server/clock.hpp"
#include "server/config/config.hpp"
#include "server/pose/posed_body.hpp"

namespace sonard::server {

/// Where everything was for one ping.
struct PosesUsed {
  TimePoint time{};  ///< of the transmission
  render::Pose T_world_vehicle;
  render::Pose T_world_sonar;     ///< of the mount
  std::vector<PosedBody> bodies;  ///< those that were heard of
};

/// A ping of a Gemini goes onto the wire.
struct GeminiPingServed {
  gemini::ServedPing served;
  TimePoint transmit_time{};
  double gain_percent = 50.0;
  std::shared_ptr<const PosesUsed> poses;
};

/// A status packet of a Gemini, as it goes to everybody.
struct GeminiStatusSent {
  gemini::SharedBytes datagram;
};

/// A line of a Micron has left.
struct MicronLineSent {
  micron::SentLine line;
  micron::MicronJob job;
  std::shared_ptr<const PosesUsed> poses;
};

/// A ping is about to be rendered.
struct PingPosed {
  std::shared_ptr<const PosesUsed> poses;
};

enum class WireTransport : std::uint8_t { udp, tcp, pty };

/// The two ends of a wire. Those of a pseudo terminal have no addresses.
struct WireEnds {
  WireTransport transport = WireTransport::udp;
  Endpoint client;
  Endpoint head;
  std::string pty;  ///< path of the slave
};

struct WirePiece {
  Endpoint client;
  Endpoint head;
  gemini::SharedBytes bytes;
};

/// Datagrams, or pieces of a stream, as they passed the socket in one go.
struct WirePassed {
  bool to_client = false;
  WireTransport transport = WireTransport::udp;
  std::string pty;  ///< path of the slave
  std::vector<WirePiece> pieces;
};

/// A stream has come to its end.
struct ClientLeft {
  WireEnds ends;
};

struct RecordingEvent {
  int head = 0;      ///< its place in the configuration
  TimePoint time{};  ///< when it happened
  std::variant<GeminiPingServed, GeminiStatusSent, MicronLineSent, PingPosed, WirePassed, ClientLeft> what;
};

/// Bytes of memory that an event holds, near enough for a bound. What events share counts for each.
std::size_t memory_of(const RecordingEvent& event);

}  // namespace sonard::server
