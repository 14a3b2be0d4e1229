// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes of three clients, images, faults and pauses against a head of the Ping protocol.
// Promises, beside those of all heads: every frame sent is a whole message of a head, for one peer.
#pragma once

#include <cstdint>
#include <span>
#include <variant>

#include "protocol/ping/clients.hpp"
#include "protocol/ping/messages.hpp"
#include "tests/fuzz/device_fuzzer.hpp"

namespace sonard::fuzz {

/// fuzz_pingNAME_device.cpp derives the one of its device, which says how to read messages and records.
template <class Device, class DeviceConfig>
class PingDeviceFuzzer : public DeviceFuzzer {
 public:
  explicit PingDeviceFuzzer(const DeviceConfig& config) : config_(config) {}

  int byte_kinds() const override { return client_gone; }

 protected:
  /// The part of a configuration that the lower half of the first byte of an input selects, and its last bit.
  static DeviceConfig config_of(unsigned flags) {
    DeviceConfig config;
    config.serial_channel = serial_channel;
    config.plays_back = (flags & 0x01U) != 0;
    config.simulated_time = (flags & 0x02U) != 0;
    config.fan_out = (flags & 0x04U) != 0 ? ping::FanOut::all : ping::FanOut::requester;
    config.time_scale = (flags & 0x08U) != 0 ? 0.0 : 1.0;
    config.max_clients = (flags & 0x80U) != 0 ? 2 : 32;
    return config;
  }

  /// Wire form of a recorded ping of 20 bins.
  virtual std::vector<std::uint8_t> recorded_wire() const = 0;
  /// True for a message that a head may send.
  virtual bool is_report(std::span<const std::uint8_t> frame) const = 0;
  virtual bool is_recorded(std::span<const std::uint8_t> wire) const = 0;

 private:
  /// Kinds of events. The first three carry bytes, each from its own client: number and payload of a message,
  /// or a raw piece of stream.
  enum Kind { client_gone = 3, image = 4, image_failed = 5, feed = 6, next_due = 7 };
  static constexpr int serial_channel = 2;

  static Peer peer_of(int kind) {
    const auto number = static_cast<std::uint16_t>(kind);
    return kind == serial_channel ? Peer{serial_channel, {}, 0} : Peer{0, {0x7F000001, number}, 0};
  }

  sonard::Device& device() override { return device_; }
  const PingCounters& counters() const override { return device_.counters(); }
  bool plays_back() const override { return config_.plays_back; }

  void happen(const Event& event) override {
    switch (event.kind) {
      case client_gone:
        step(ClientGone{peer_of(0)});
        break;
      case image:
        answer_job(true);
        break;
      case image_failed:
        answer_job(false);
        break;
      case feed:
        step(PingFed{recorded()});
        break;
      case next_due:
        begin_next();
        break;
      default:
        hear(event);
    }
  }

  ReplayedPing recorded() const {
    ReplayedPing ping;
    ping.settings = {.bins = 20, .beams = 1, .bin_m = 0.1, .sound_speed_mps = 1500.0};
    ping.wire = recorded_wire();
    return ping;
  }

  void hear(const Event& event) {
    const std::span<const std::uint8_t> bytes = event.datagram;
    const bool as_is = event.as_is || bytes.size() < 2;
    step(BytesReceived{
        peer_of(event.kind),
        SharedBytes(as_is ? event.datagram
                          : ping::make_frame(static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8),
                                             ping::client_id, 0, bytes.subspan(2)))});
  }

  void check_message(const Outgoing& outgoing) override {
    require(outgoing.to == Outgoing::To::peer, "messages are for one peer each");
    if (config_.max_datagram > 0) {
      require(outgoing.bytes.size() <= config_.max_datagram, "datagrams are as short as they are to be");
      return;
    }
    const std::span<const std::uint8_t> frame{outgoing.bytes};
    require(ping::next_frame(frame) == static_cast<std::ptrdiff_t>(frame.size()),
            "one whole frame at a time");
    require(is_report(frame), "a head speaks its own protocol");
  }

  void check_job(const PingJob& job) const override { check_line_job(job); }
  void check_record(const PingRecord& record) const override {
    require(is_recorded(record.wire), "a record can be played");
  }

  DeviceConfig config_;
  Device device_{config_, {}};
};

}  // namespace sonard::fuzz
