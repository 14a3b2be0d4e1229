// SPDX-License-Identifier: Apache-2.0
// The clients of a head of the Ping protocol, on UDP ports and at most one serial line.
// Source: protocol/ping360/README.md 4.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/ping/frame.hpp"

namespace sonard::ping {

/// Receivers of the head's messages (4.2).
enum class FanOut : std::uint8_t {
  requester,  ///< the client that requested it, or started the scan or stream
  all,        ///< every client, as behind the bridge of a vehicle
};

struct ClientsConfig {
  /// A client that is silent for this time is dropped. 0: never. Clients on a serial line are never dropped.
  std::chrono::nanoseconds idle_timeout{0};
  FanOut fan_out = FanOut::requester;
  std::size_t max_clients = 32;  ///< >= 2; beyond that the client that has been silent longest is dropped
  /// Maximum bytes of a datagram; longer frames are split. 0: one datagram per frame (4.1).
  std::size_t max_datagram = 0;
  /// Only the first address that sends a command controls the head, until it is silent for `idle_timeout`,
  /// which must be > 0. Datagrams of others are dropped (docs/security.md).
  bool lock_to_first = false;
  std::size_t max_payload = max_payload_size;  ///< of a client's frame; a longer one is noise (1.1)
  int serial_channel = -1;  ///< the Peer::channel of the serial line; -1: no serial line (4.4)
};

/// The field that is out of range, and its range; nullopt if all values are valid.
std::optional<std::string> invalid_field(const ClientsConfig& config);

/// True if two messages are from one client.
inline bool same_client(const Peer& a, const Peer& b) {
  return a.channel == b.channel && a.remote == b.remote;
}

/// Not thread-safe; `now` never goes backwards.
class Clients {
 public:
  struct Client {
    Peer peer;
    FrameBuffer input;
    TimePoint heard{};
  };

  /// @param config valid; must outlive this object
  explicit Clients(const ClientsConfig& config) : config_(config) {}

  /// True if another address holds the head. The holder's bytes extend its hold.
  bool locked_against(TimePoint now, const Peer& peer);
  /// `peer` has sent a command: it holds the head, if the head is locked to the first client.
  void hold(TimePoint now, const Peer& peer) { holder_ = Holder{peer.remote.address, now}; }

  /// The known client with this peer; nullptr if there is none.
  Client* find(const Peer& peer);
  /// The client that sent bytes at `now`. A new one takes the place of the client that has been silent
  /// longest, if there are too many. Clients for which `keeps` is true are dropped last, because they may
  /// only listen.
  Client& heard(TimePoint now, const Peer& peer, const std::function<bool(const Peer&)>& keeps);
  /// Clients that have been silent for too long.
  std::vector<Peer> silent(TimePoint now) const;
  /// When the next client may be silent for too long; nullopt: never.
  std::optional<TimePoint> next_silence() const;
  void remove(const Peer& peer);
  /// Forgets all clients, as a restarted head does.
  void clear();

  bool empty() const { return clients_.empty(); }
  std::uint64_t dropped() const { return dropped_; }  ///< because there were too many
  bool is_serial(const Peer& peer) const { return peer.channel == config_.serial_channel; }
  /// "127.0.0.1:4000" or "on the serial line".
  std::string name_of(const Peer& peer) const;

  /// Appends a frame for a client, or for all of them, to `out`.
  void send(const Peer& to, const std::vector<std::uint8_t>& frame, std::vector<Outgoing>& out) const;

 private:
  /// The address that controls the head while it is locked to the first client.
  struct Holder {
    Ipv4 address = 0;  ///< 0: the serial line
    TimePoint heard{};
  };

  bool can_fall_silent(const Client& client) const;
  void send_to(const Peer& to, const std::vector<std::uint8_t>& frame, std::vector<Outgoing>& out) const;

  const ClientsConfig& config_;
  std::vector<Client> clients_;
  std::optional<Holder> holder_;
  std::uint64_t dropped_ = 0;
};

}  // namespace sonard::ping
