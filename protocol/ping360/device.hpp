// SPDX-License-Identifier: Apache-2.0
// The Ping360 as a pure state machine: input is bytes and time, output is frames and jobs.
// It uses no sockets, serial ports, clocks or threads. Source: protocol/ping360/README.md.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/ping360/device_config.hpp"
#include "protocol/ping360/device_counters.hpp"

namespace sonard::ping360 {

/// One head on any number of channels: UDP ports and at most one serial line. On a UDP port an empty
/// BytesReceived is an empty datagram, which ends a scan. Clients are distinguished by channel and remote
/// end; every message goes to one peer, never to everybody. If the caller is late, the transmit time of a job
/// may be up to 50 ms in the past.
class Device final : public sonard::Device {
 public:
  /// A head that was powered up earlier, with the settings of a head at boot.
  /// @throws std::invalid_argument naming the field of `config` that is out of range
  Device(const DeviceConfig& config, TimePoint start);
  ~Device() override;

  Actions step(TimePoint now, const Event& event) override;
  PingProgress progress() const override;
  std::vector<Counter> counts() const override;

  const DeviceCounters& counters() const;
  std::uint8_t id() const;  ///< the current device id

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::ping360
