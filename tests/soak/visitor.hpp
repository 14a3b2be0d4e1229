// SPDX-License-Identifier: Apache-2.0
// A client that comes to a head, takes some pings, and leaves. Each type of head has one, which uses our
// client code.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/common/device.hpp"

namespace sonard::soak {

/// A ping as a client receives it.
struct SeenPing {
  /// Identifies the ping: its number if the head numbers pings, else the angle of a scanning head. From ping
  /// to ping it grows by HeadUnderSoak::id_step, modulo HeadUnderSoak::id_modulus.
  std::uint64_t id = 0;
  std::vector<std::uint8_t> samples;

  /// The transmit time in the message, by the head's clock, in nanoseconds since it booted.
  struct Stamp {
    std::int64_t ns = 0;
    std::int64_t resolution_ns = 1;  ///< smaller parts are cut off or rounded
    std::int64_t modulus_ns = 0;     ///< 0: does not wrap
  };
  std::optional<Stamp> stamp;  ///< nullopt: this type of head sends no stamps
};

/// One visit. Its time is the argument of its methods, which never decreases.
class Visitor {
 public:
  Visitor() = default;
  virtual ~Visitor() = default;
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

  /// Events at the head when the visitor comes, before its first message.
  virtual std::vector<Event> come() { return {}; }
  /// Receives a message of the head.
  virtual void hear(TimePoint now, const Outgoing& message) = 0;
  /// Does the work that is due. Returns the visitor's messages in order.
  virtual std::vector<Event> advance(TimePoint now) = 0;
  virtual std::optional<TimePoint> next_deadline() const = 0;
  /// The pings received since the last call.
  virtual std::vector<SeenPing> take_pings() = 0;
  /// Events at the head when the visitor leaves: half a command, and for some types the end of the
  /// connection.
  virtual std::vector<Event> leave() = 0;
};

/// A type of head and its visitors.
class HeadUnderSoak {
 public:
  HeadUnderSoak() = default;
  virtual ~HeadUnderSoak() = default;
  HeadUnderSoak(const HeadUnderSoak&) = delete;
  HeadUnderSoak& operator=(const HeadUnderSoak&) = delete;

  virtual Device& device() = 0;
  virtual int beams() const = 0;
  virtual std::uint64_t id_step() const = 0;
  virtual std::uint64_t id_modulus() const = 0;
  /// The exact time from ping to ping in one visit; nullopt if it depends on the angle.
  virtual std::optional<std::chrono::nanoseconds> period() const = 0;
  /// The samples that the head sends of an image.
  virtual std::vector<std::uint8_t> made_of(const std::vector<std::uint8_t>& image) const { return image; }
  /// Creates a visitor. Visitors differ in address, in requests and in the way they leave; half of them leave
  /// without a message.
  virtual std::unique_ptr<Visitor> visitor(std::uint64_t visit, TimePoint now) = 0;
  /// Checks a message of the head, also if no visitor receives it. @throws std::runtime_error with the error
  virtual void check(TimePoint now, const Outgoing& message) = 0;
};

struct TypeUnderSoak {
  std::string_view name;
  std::unique_ptr<HeadUnderSoak> (*make)();
};
/// In the order of cmake/devices.cmake; the build writes this function.
std::span<const TypeUnderSoak> types_under_soak();

/// The echoes of a job with directions, from the samples of its image.
DirectionRanges echoes_of(const std::vector<std::uint8_t>& samples, const Directions& directions);

/// @throws std::runtime_error{what} if `condition` is false
void require(bool condition, const char* what);

}  // namespace sonard::soak
