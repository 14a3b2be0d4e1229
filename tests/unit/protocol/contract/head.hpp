// SPDX-License-Identifier: Apache-2.0
// A device type as the contract suite sees it. NAME.cpp implements it for one device of cmake/devices.cmake.
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <span>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/common/ping_cycle.hpp"
#include "tests/support/device_bench.hpp"

namespace sonard::contract {

struct Mode {
  bool simulated_time = false;
  bool plays_back = false;
  unsigned options = 0;  ///< its bits choose options of the type
};

/// A head and its only client, which speaks to the head through the bench.
class Head {
 public:
  Head() = default;
  virtual ~Head() = default;
  Head(const Head&) = delete;
  Head& operator=(const Head&) = delete;

  virtual Device& device() = 0;
  virtual const PingCounters& counters() const = 0;
  /// Beams of an image whose job does not say how many.
  virtual int beams() const { return 1; }

  /// The client comes and makes the head ready for requests. May take 15 s.
  virtual void connect(DeviceBench& bench) const = 0;
  /// The client requests one ping or more. The first one is sent within 300 ms if it is rendered at once.
  virtual void request(DeviceBench& bench) const = 0;
  /// The client ends all pings that it has requested.
  virtual void cancel(DeviceBench& bench) const = 0;
  /// The client goes, or is lost. May take 5 s.
  virtual void leave(DeviceBench& bench) const = 0;

  /// A ping that the head can send in playback, with at most 64 bins.
  virtual ReplayedPing recorded() const = 0;

  virtual Peer client() const = 0;
  /// Peers that send messages().
  virtual std::vector<Peer> clients() const { return {client()}; }
  /// Messages of clients, to be cut and corrupted. Half of them request pings. The last one is sent rarely: a
  /// head may take seconds until it answers again.
  virtual std::vector<std::vector<std::uint8_t>> messages() const = 0;
  /// Whether a ping has a record that is broken off after its first messages.
  virtual bool records_broken_pings() const { return false; }
  /// Whether a client can read a message that the head sent.
  virtual bool can_read(std::span<const std::uint8_t> message) const = 0;
};

struct HeadType {
  const char* name;
  std::unique_ptr<Head> (*make)(const Mode& mode);

  friend std::ostream& operator<<(std::ostream& out, const HeadType& type) { return out << type.name; }
};

/// The devices of cmake/devices.cmake.
std::span<const HeadType> head_types();

}  // namespace sonard::contract
