// SPDX-License-Identifier: Apache-2.0
// An Oculus as a pure state machine: input is bytes and time, output is messages and jobs.
// Source: protocol/oculus/README.md.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/common/ping_cycle.hpp"
#include "protocol/oculus/device_config.hpp"

namespace sonard::oculus {

/// One head with one client at a time. Its channels are the stream of that client and the broadcast of status
/// datagrams. It disconnects a second client at once and ignores its bytes. But if the first client has no
/// pings and has sent no command for most_silence, the second client replaces it.
class Device final : public sonard::Device {
 public:
  static constexpr int stream_channel = 0;
  static constexpr int status_channel = 1;
  static constexpr std::chrono::seconds most_silence{30};

  /// @throws std::invalid_argument naming the field of `config` that is out of range
  Device(const DeviceConfig& config, TimePoint boot_time);
  ~Device() override;

  Actions step(TimePoint now, const Event& event) override;
  PingProgress progress() const override;
  std::vector<Counter> counts() const override;

  const PingCounters& counters() const;
  /// Sets a new address of the machine that serves the head. Status datagrams report it from now on.
  void move_to(Ipv4 address, Ipv4 netmask);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::oculus
