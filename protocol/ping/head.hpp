// SPDX-License-Identifier: Apache-2.0
// The side of a head that its clients see, for all devices of the Ping protocol: frames in, answers out.
// Source: protocol/ping360/README.md 1, 4.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/common/once_warnings.hpp"
#include "protocol/common/ping_cycle.hpp"
#include "protocol/ping/clients.hpp"
#include "protocol/ping/messages.hpp"

namespace sonard::ping {

/// Counters of a head's work and rejected input. They only grow, also across restarts of the head.
struct HeadCounters : PingCounters {
  std::uint64_t commands = 0;            ///< understood
  std::uint64_t refused = 0;             ///< answered by a nack
  std::uint64_t dropped_bytes = 0;       ///< not part of a frame
  std::uint64_t bad_checksums = 0;       ///< frames with a wrong checksum
  std::uint64_t other_destinations = 0;  ///< frames for another device
  std::uint64_t unheard_bytes = 0;       ///< arrived while the head restarted
  std::uint64_t clients_dropped = 0;     ///< there were too many clients
  std::uint64_t locked_out = 0;          ///< datagrams of other addresses, by ClientsConfig::lock_to_first
};

/// Not thread-safe; `now` never goes backwards. The device derives from it.
class Head {
 public:
  /// `config` and `counters` must outlive the head. With `any_destination` it takes frames to other ids than
  /// its own, 0 and 255.
  Head(const ClientsConfig& config, std::uint8_t id, bool any_destination, HeadCounters& counters)
      : clients_(config), id_(id), any_destination_(any_destination), counts_(counters) {}
  virtual ~Head() = default;
  Head(const Head&) = delete;
  Head& operator=(const Head&) = delete;

  void receive(TimePoint now, const BytesReceived& piece);
  void take(TimePoint now, const ClientGone& gone);

 protected:
  // ---- The device's part

  /// True for a client that may only listen.
  virtual bool keeps(const Peer& peer) const = 0;
  /// Bytes of a client are about to be read.
  virtual void on_bytes(TimePoint /*now*/) {}
  /// A datagram without bytes has come. True: it is not to be read.
  virtual bool on_empty(TimePoint /*now*/, Clients::Client& /*client*/) { return false; }
  /// Called before each frame and after the last one of a piece.
  virtual void between_frames(TimePoint /*now*/, Clients::Client& /*client*/) {}
  /// Obeys a frame for this head. False: its payload has a wrong length.
  virtual bool obey(TimePoint now, const Peer& asker, std::span<const std::uint8_t> frame) = 0;
  /// The client is about to be forgotten.
  virtual void on_forget(TimePoint now, const Peer& peer, std::string_view why) = 0;

  /// Counts a decoded command, holds the head for its client, and calls `handle` with the message. False if
  /// it could not be decoded.
  template <class Decoded, class Handle>
  bool obey(TimePoint now, const Peer& asker, const Decoded& command, const Handle& handle) {
    if (command) {
      counts_.commands += std::holds_alternative<Unknown>(*command) ? 0 : 1;
      clients_.hold(now, asker);
      std::visit(handle, *command);
    }
    return command.has_value();
  }

  // ---- Answers

  void send(const Peer& to, const std::vector<std::uint8_t>& frame) { clients_.send(to, frame, outgoing_); }
  void ack(const Peer& asker, std::uint16_t id);
  void nack(const Peer& asker, std::uint16_t id, std::string_view text);
  /// Answers by a nack, and warns once. `text` is a literal.
  void refuse(const Peer& asker, std::uint16_t id, std::string_view text);
  /// Refuses a value beyond its limits. `field` is a literal.
  void refuse(const Peer& asker, std::uint16_t id, std::string_view field, std::int64_t value,
              std::int64_t least, std::int64_t most);
  void notice(std::string text) { notices_.push_back({Notice::Level::info, std::move(text)}); }

  /// Takes no bytes until then. All clients are forgotten, as soon as their bytes are read.
  void restart(TimePoint silent_until) { silent_until_ = silent_until; }
  void forget(TimePoint now, const Peer& peer, std::string_view why);
  void forget_silent(TimePoint now);
  /// Moves what has come up since the last call into `actions`.
  void report(Actions& actions);

  Clients clients_;
  std::uint8_t id_;

 private:
  void read(TimePoint now, Clients::Client& client);
  void take_frame(TimePoint now, const Peer& asker, std::span<const std::uint8_t> frame);

  const bool any_destination_;
  HeadCounters& counts_;
  TimePoint silent_until_ = TimePoint::min();  ///< in the future while the head restarts
  std::vector<Outgoing> outgoing_;
  std::vector<Notice> notices_;
  OnceWarnings warnings_;
};

}  // namespace sonard::ping
