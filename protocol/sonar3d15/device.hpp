// SPDX-License-Identifier: Apache-2.0
// A Sonar 3D-15 as a pure state machine: input is bytes and time, output is messages and jobs.
// Source: protocol/sonar3d15/README.md.
#pragma once

#include <memory>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/common/ping_cycle.hpp"
#include "protocol/sonar3d15/device_config.hpp"

namespace sonard::sonar3d15 {

/// One head. Its clients:
/// * `control_channel`: streams of HTTP/1.1 over TCP, one per client. The head takes any part of a stream,
/// answers each
///   whole request on the same stream, and disconnects a client after a request that ends the connection or
///   is not HTTP. All clients share its settings.
/// * `image_channel`: datagrams to the multicast group or to the one destination that a client has set.
/// Nobody
///   registers for them, so the head sends them while acoustics are on; the network may lose them.
///
/// A shot is a PingJob with directions and without an image. Its `mode` is 0 for low and 1 for high
/// frequency. A recorded shot is a fan of samples whose PingRecord::wire has both images.
class Device final : public sonard::Device {
 public:
  static constexpr int control_channel = 0;
  static constexpr int image_channel = 1;

  /// @throws std::invalid_argument naming the field of `config` that is out of range
  Device(const DeviceConfig& config, TimePoint boot_time);
  ~Device() override;

  Actions step(TimePoint now, const Event& event) override;
  PingProgress progress() const override;
  std::vector<Counter> counts() const override;

  const PingCounters& counters() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::sonar3d15
