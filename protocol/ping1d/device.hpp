// SPDX-License-Identifier: Apache-2.0
// The Ping1D and the Ping2 as a pure state machine: input is bytes and time, output is frames and jobs.
// It uses no sockets, serial ports, clocks or threads. Source: protocol/ping1d/README.md.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/ping1d/device_config.hpp"
#include "protocol/ping1d/device_counters.hpp"

namespace sonard::ping1d {

/// One head on any number of channels: UDP ports and at most one serial line. It pings while a client has a
/// stream, and for `idle_timeout` after the newest bytes of any client. Clients are distinguished by channel
/// and remote end. If the caller is late, the transmit time of a job may be up to one period in the past.
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

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::ping1d
