// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes of three clients, images, faults and pauses against a Ping360.
#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/device.hpp"
#include "protocol/ping360/recorded_form.hpp"
#include "tests/fuzz/ping_device_fuzzer.hpp"

namespace sonard::fuzz {
namespace {

using namespace ping360;

class Ping360Fuzzer final : public PingDeviceFuzzer<ping360::Device, DeviceConfig> {
 public:
  explicit Ping360Fuzzer(unsigned flags) : PingDeviceFuzzer(config_by(flags)) {}

 private:
  static DeviceConfig config_by(unsigned flags) {
    DeviceConfig config = config_of(flags);
    config.max_datagram = (flags & 0x10U) != 0 ? 100 : 0;
    config.signed_scan_angles = (flags & 0x20U) != 0;
    config.clamps_scan_to_stop = (flags & 0x40U) != 0;
    return config;
  }

  int most_bins() const override { return 1200; }
  std::vector<std::uint8_t> recorded_wire() const override {
    return ping360::recorded_wire(form_of(Transducer{.angle = 50, .number_of_samples = 20}), 2);
  }
  bool is_report(std::span<const std::uint8_t> frame) const override {
    const auto report = decode_report(frame);
    return report.has_value() && !std::holds_alternative<Unknown>(*report);
  }
  bool is_recorded(std::span<const std::uint8_t> wire) const override {
    return recorded_form(wire).has_value();
  }
};

}  // namespace

std::unique_ptr<DeviceFuzzer> make_device_fuzzer(unsigned flags) {
  return std::make_unique<Ping360Fuzzer>(flags);
}

}  // namespace sonard::fuzz
