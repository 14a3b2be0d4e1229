// SPDX-License-Identifier: Apache-2.0
// The Gemini 720i as a pure state machine: datagrams and time go in; datagrams and jobs come out.
// It knows no sockets, clocks, threads or images beyond sample bytes. Source: docs/protocols/gemini.md.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/gemini/device_config.hpp"
#include "protocol/gemini/device_counters.hpp"

namespace sonard::gemini {

/// The addresses a head answers on, and the mask it reports.
struct DeviceAddresses {
  Ipv4 fixed = 0;
  Ipv4 alternate = 0;
  Ipv4 netmask = 0;

  bool operator==(const DeviceAddresses&) const = default;
};

/// One head. It has one channel: the socket on port 52901. What goes to everybody is a status packet. Steps
/// that come late are caught up within the pacing rules: no more than DeviceConfig::burst_lines ping
/// datagrams leave at once. Out of the water the head does not ping unless the configuration says so, and
/// reports it in its status. A job may come before its transmit time by DeviceConfig::render_lead.
class Device final : public sonard::Device {
 public:
  /// Boots at `boot_time`: the clock of the head is 0 then, and the first status is due.
  /// @throws std::invalid_argument naming the field of `config` that is out of range
  Device(const DeviceConfig& config, TimePoint boot_time);
  ~Device() override;

  Actions step(TimePoint now, const Event& event) override;
  PingProgress progress() const override;
  std::vector<Counter> counts() const override;

  const DeviceCounters& counters() const;
  /// The connected topside; 0 when none is.
  Ipv4 topside() const;
  /// What the head answers on. Changes when a reboot applies an address that a client has programmed
  /// (3.7, 3.9); the server then moves its sockets while the head is still silent.
  DeviceAddresses addresses() const;
  /// The machine that serves the head has another address: status packets report it from now on, and a reboot
  /// keeps it, as if it had been programmed.
  void move_to(Ipv4 alternate, Ipv4 netmask);
  /// Microseconds of the head's clock at `now`; 0 while it reboots.
  std::uint64_t clock_us(TimePoint now) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::gemini
