// SPDX-License-Identifier: Apache-2.0
// The DVL as a pure state machine: input is bytes, ranges and time, output is messages and jobs.
// It uses no sockets, serial ports, clocks or threads. Source: protocol/dvl_a50/README.md.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/dvl_a50/device_config.hpp"
#include "protocol/dvl_a50/device_counters.hpp"

namespace sonard::dvl_a50 {

/// A device with clients of JSON on channel 0 and, as DeviceConfig has them, of PD6, PD4 and HTTP, and one
/// serial line. It pings while a client is connected, or always if it has a serial line. Its head has the
/// axes of motion.hpp. If the caller is late, the transmit time of a job may be up to one period in the past.
class Device final : public sonard::Device {
 public:
  /// A device that was powered up earlier.
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

}  // namespace sonard::dvl_a50
