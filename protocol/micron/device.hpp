// SPDX-License-Identifier: Apache-2.0
// The Micron as a pure state machine: input is bytes and time, output is frames and jobs.
// It uses no sockets, serial ports, clocks or threads. Source: protocol/micron/README.md.
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
  booting,             ///< neither receives nor sends
  centring,            ///< turns to its centre; accepts parameters
  without_parameters,  ///< centred
  ready,
  scanning,  ///< lines are owed
};

/// "booting", "centring", "without_parameters", "ready", "scanning".
std::string_view to_string(HeadState state);

/// One head on one line that all clients share. It runs with or without clients; the caller discards its
/// output if no client is connected. Every message that it sends is one whole frame for everybody, to write
/// at once. If the caller is late, the transmit time of a job may be up to 50 ms in the past.
class Device final : public sonard::Device {
 public:
  /// A head that was powered up earlier: at `start` it is centred and has no parameters.
  /// @throws std::invalid_argument naming the field of `config` that is out of range
  Device(const DeviceConfig& config, TimePoint start);
  ~Device() override;

  Actions step(TimePoint now, const Event& event) override;
  PingProgress progress() const override;
  std::vector<Counter> counts() const override;

  /// Simulates a power cycle: a reboot without a command.
  void power_cycle(TimePoint now);
  /// Simulates a lost motor step: lines report it until new parameters come.
  void lose_step();

  const DeviceCounters& counters() const;
  HeadState state(TimePoint now) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::micron
