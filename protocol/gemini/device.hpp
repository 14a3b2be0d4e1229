// SPDX-License-Identifier: Apache-2.0
// The Gemini 720i as a pure state machine: input is datagrams and time, output is datagrams and jobs.
// It uses no sockets, clocks or threads, and of images only sample bytes. Source: protocol/gemini/README.md.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/gemini/device_config.hpp"
#include "protocol/gemini/device_counters.hpp"

namespace sonard::gemini {

/// The addresses that a head answers on, and the mask that it reports.
struct DeviceAddresses {
  Ipv4 fixed = 0;
  Ipv4 alternate = 0;
  Ipv4 netmask = 0;

  bool operator==(const DeviceAddresses&) const = default;
};

/// One head with one channel, the socket on port 52901. It broadcasts only status packets. It catches up
/// after late steps within the pacing rules: at most DeviceConfig::burst_lines ping datagrams leave at once.
/// Out of the water the head reports this in its status; it pings only if the ping configuration requests it.
/// A job may come up to DeviceConfig::render_lead before its transmit time.
class Device final : public sonard::Device {
 public:
  /// Boots at `boot_time`, when the clock of the head is 0 and the first status is due.
  /// @throws std::invalid_argument naming the field of `config` that is out of range
  Device(const DeviceConfig& config, TimePoint boot_time);
  ~Device() override;

  Actions step(TimePoint now, const Event& event) override;
  PingProgress progress() const override;
  std::vector<Counter> counts() const override;

  const DeviceCounters& counters() const;
  /// The connected client; 0 if no client is connected.
  Ipv4 client() const;
  /// The addresses that the head answers on. They change when a reboot applies an address that a client has
  /// programmed (3.7, 3.9). The server then moves its sockets while the head is still silent.
  DeviceAddresses addresses() const;
  /// Sets a new address of the machine that serves the head. Status packets report it from now on. A reboot
  /// keeps it, like a programmed address.
  void move_to(Ipv4 alternate, Ipv4 netmask);
  /// The head's clock at `now` in microseconds; 0 while it reboots.
  std::uint64_t clock_us(TimePoint now) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::gemini
