// SPDX-License-Identifier: Apache-2.0
// An Oculus as a pure state machine: bytes and time go in; messages and jobs come out.
// Source: docs/protocols/oculus.md.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/oculus/device_config.hpp"

namespace sonard::oculus {

/// One head, with one client at a time. Its channels are the stream of that client and the status datagrams,
/// which go to everybody. A second client is disconnected at once, and what it sends is not read; but it
/// takes the place of a client that has no pings and sent no command for most_silence.
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

  /// The machine that serves the head has another address: status datagrams report it from now on.
  void move_to(Ipv4 address, Ipv4 netmask);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::oculus
