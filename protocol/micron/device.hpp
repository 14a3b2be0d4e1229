// SPDX-License-Identifier: Apache-2.0
// The Micron as a pure state machine: bytes and time go in; frames and jobs come out.
// It knows no sockets, serial ports, clocks or threads. Source: docs/protocols/micron.md.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/micron/device_config.hpp"
#include "protocol/micron/device_counters.hpp"

namespace sonard::micron {

enum class HeadState : std::uint8_t {
  booting,             ///< deaf and dumb
  centring,            ///< looks for its centre; takes parameters
  without_parameters,  ///< centred
  ready,
  scanning,  ///< lines are owed
};

/// "booting", "centring", "without_parameters", "ready", "scanning".
std::string_view to_string(HeadState state);

/// One head on one line that all clients share. It runs whether a client listens or not: the caller discards
/// what it sends while none is connected. Every message it sends is one whole frame for
/// everybody, to be written in one go. A job's transmit time is up to 50 ms before now where the caller is
/// late.
class Device final : public sonard::Device {
 public:
  /// A head that was powered up in time: at `start` it is centred and has no parameters.
  /// @throws std::invalid_argument naming the field of `config` that is out of range
  Device(const DeviceConfig& config, TimePoint start);
  ~Device() override;

  Actions step(TimePoint now, const Event& event) override;
  PingProgress progress() const override;
  std::vector<Counter> counts() const override;

  /// Power fails and comes back: a reboot without a command.
  void power_cycle(TimePoint now);
  /// The motor loses its step: lines say so until new parameters come.
  void lose_step();

  const DeviceCounters& counters() const;
  HeadState state(TimePoint now) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::micron
