// SPDX-License-Identifier: Apache-2.0
// A client that comes to a head, takes some pings, and leaves: the code of our clients, one kind of head
// each.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "protocol/common/device.hpp"

namespace sonard::soak {

/// A ping as a client has it.
struct SeenPing {
  /// Which it is: its number where the head gives it one, else where a scanning head looked. Of those that
  /// follow each other it grows by HeadUnderSoak::id_step, modulo HeadUnderSoak::id_modulus.
  std::uint64_t id = 0;
  std::vector<std::uint8_t> samples;

  /// The transmit time by the head's clock, in nanoseconds since it booted, as far as its message says.
  struct Stamp {
    std::int64_t ns = 0;
    std::int64_t resolution_ns = 1;  ///< what lies below is cut off, or rounded away
    std::int64_t modulus_ns = 0;     ///< 0: it does not wrap
  };
  std::optional<Stamp> stamp;  ///< nullopt: messages of this kind of head have none
};

/// One visit. It lives in the time that its methods are given, which never goes backwards.
class Visitor {
 public:
  Visitor() = default;
  virtual ~Visitor() = default;
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

  /// What happens to the head as the visitor comes, before its first word.
  virtual std::vector<Event> come() { return {}; }
  /// A message of the head that reaches it.
  virtual void hear(TimePoint now, const Outgoing& message) = 0;
  /// Runs what is due; what the visitor then says, in order.
  virtual std::vector<Event> advance(TimePoint now) = 0;
  virtual std::optional<TimePoint> next_deadline() const = 0;
  /// Those that have come since the last call.
  virtual std::vector<SeenPing> take_pings() = 0;
  /// What happens to the head as the visitor leaves in the middle of everything, half a command last.
  virtual std::vector<Event> leave() = 0;
};

/// A kind of head, and who comes to it.
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
  /// From ping to ping of one visit, exactly; nullopt: it depends on where the head looks.
  virtual std::optional<std::chrono::nanoseconds> period() const = 0;
  /// Visitors differ in address, in what they ask for and in how they leave. Half of them leave without a
  /// word.
  virtual std::unique_ptr<Visitor> visitor(std::uint64_t visit, TimePoint now) = 0;
  /// Looks at a message that the head sends, whoever hears it. @throws std::runtime_error of what is wrong in
  /// it
  virtual void check(TimePoint now, const Outgoing& message) = 0;
};

std::unique_ptr<HeadUnderSoak> gemini_under_soak();
std::unique_ptr<HeadUnderSoak> micron_under_soak();
std::unique_ptr<HeadUnderSoak> ping360_under_soak();
std::unique_ptr<HeadUnderSoak> oculus_under_soak();

/// @throws std::runtime_error{what} where `condition` is false
void require(bool condition, const char* what);

}  // namespace sonard::soak
