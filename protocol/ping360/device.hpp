// SPDX-License-Identifier: Apache-2.0
// The Ping360 as a pure state machine: bytes and time go in; frames and jobs come out.
// It knows no sockets, serial ports, clocks or threads. Source: docs/protocols/ping360.md.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/ping360/device_config.hpp"
#include "protocol/ping360/device_counters.hpp"

namespace sonard::ping360 {

/// One head on any number of channels: UDP ports, where an empty BytesReceived is an empty datagram and means
/// something, and at most one serial line. Clients are told apart by channel and remote end; what they are
/// sent is for one peer each, never for everybody. A job's transmit time is up to 50 ms before now where the
/// caller is late.
class Device final : public sonard::Device {
 public:
  /// A head that was powered up in time, with the settings of its boot.
  /// @throws std::invalid_argument naming the field of `config` that is out of range
  Device(const DeviceConfig& config, TimePoint start);
  ~Device() override;

  Actions step(TimePoint now, const Event& event) override;
  PingProgress progress() const override;
  std::vector<Counter> counts() const override;

  const DeviceCounters& counters() const;
  std::uint8_t id() const;  ///< the present one

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::ping360
