// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes of three clients, images, faults and pauses against a Ping1D.
#include "protocol/ping1d/codec.hpp"
#include "protocol/ping1d/device.hpp"
#include "protocol/ping1d/recorded_form.hpp"
#include "tests/fuzz/ping_device_fuzzer.hpp"

namespace sonard::fuzz {
namespace {

using namespace ping1d;

class Ping1dFuzzer final : public PingDeviceFuzzer<ping1d::Device, DeviceConfig> {
 public:
  explicit Ping1dFuzzer(unsigned flags) : PingDeviceFuzzer(config_by(flags)) {}

 private:
  static DeviceConfig config_by(unsigned flags) {
    DeviceConfig config = config_of(flags);
    config.points = (flags & 0x10U) != 0 ? 10 : 200;
    config.acknowledges = (flags & 0x20U) == 0;
    config.refuses_silently_in_auto = (flags & 0x40U) != 0;
    return config;
  }

  int most_bins() const override { return 10'000; }
  std::vector<std::uint8_t> recorded_wire() const override {
    return record_of({.distance_mm = 700, .scan_length_mm = 2000}, {}, 1500.0, 1).wire;
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
  return std::make_unique<Ping1dFuzzer>(flags);
}

}  // namespace sonard::fuzz
