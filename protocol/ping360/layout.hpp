// SPDX-License-Identifier: Apache-2.0
// Layout tables of all messages, used by the codec for reading and writing. Offsets are from the start of the
// frame, 8 more than in protocol/ping360/README.md 2; sizes exclude the checksum at its end. Texts, and
// samples with their count, follow the table of their message; codec.cpp handles them.
#pragma once

#include <tuple>

#include "protocol/common/layout.hpp"
#include "protocol/ping/layout.hpp"
#include "protocol/ping360/messages.hpp"

namespace sonard::ping360 {

/// Table of one message or of its fixed part (protocol/common/layout.hpp); without `size` if it has none.
template <class Message>
struct Layout : CommonLayout<Message> {};

template <>
struct Layout<SetDeviceId> : WholeLayout<10> {
  static constexpr auto fields = std::tuple{Field{8, "id", &SetDeviceId::device_id}, Spare<1>{9}};
};

template <>
struct Layout<Reset> : WholeLayout<10> {
  static constexpr auto fields = std::tuple{Field{8, "bootloader", &Reset::bootloader}, Spare<1>{9}};
};

template <>
struct Layout<Transducer> : WholeLayout<22> {
  static constexpr auto fields = std::tuple{
      Field{8, "mode", &Transducer::mode},
      Field{9, "gain_setting", &Transducer::gain_setting},
      Field{10, "angle", &Transducer::angle},
      Field{12, "transmit_duration", &Transducer::transmit_duration_us},
      Field{14, "sample_period", &Transducer::sample_period},
      Field{16, "transmit_frequency", &Transducer::transmit_frequency_khz},
      Field{18, "number_of_samples", &Transducer::number_of_samples},
      Field{20, "transmit", &Transducer::transmit},
      Spare<1>{21},
  };
};

template <>
struct Layout<AutoTransmit> : WholeLayout<24> {
  static constexpr auto fields = std::tuple{
      Field{8, "mode", &AutoTransmit::mode},
      Field{9, "gain_setting", &AutoTransmit::gain_setting},
      Field{10, "transmit_duration", &AutoTransmit::transmit_duration_us},
      Field{12, "sample_period", &AutoTransmit::sample_period},
      Field{14, "transmit_frequency", &AutoTransmit::transmit_frequency_khz},
      Field{16, "number_of_samples", &AutoTransmit::number_of_samples},
      Field{18, "start_angle", &AutoTransmit::start_angle},
      Field{20, "stop_angle", &AutoTransmit::stop_angle},
      Field{22, "num_steps", &AutoTransmit::num_steps},
      Field{23, "delay", &AutoTransmit::delay_ms},
  };
};

/// Up to the count of its samples.
template <>
struct Layout<DeviceData> : WholeLayout<20> {
  static constexpr auto fields = std::tuple{
      Field{8, "mode", &DeviceData::mode},
      Field{9, "gain_setting", &DeviceData::gain_setting},
      Field{10, "angle", &DeviceData::angle},
      Field{12, "transmit_duration", &DeviceData::transmit_duration_us},
      Field{14, "sample_period", &DeviceData::sample_period},
      Field{16, "transmit_frequency", &DeviceData::transmit_frequency_khz},
      Field{18, "number_of_samples", &DeviceData::number_of_samples},
  };
};

/// Without the samples and their count. The order of fields differs from the command.
template <>
struct Layout<AutoDeviceData> : WholeLayout<26> {
  static constexpr auto fields = std::tuple{
      Field{8, "mode", &AutoDeviceData::mode},
      Field{9, "gain_setting", &AutoDeviceData::gain_setting},
      Field{10, "angle", &AutoDeviceData::angle},
      Field{12, "transmit_duration", &AutoDeviceData::transmit_duration_us},
      Field{14, "sample_period", &AutoDeviceData::sample_period},
      Field{16, "transmit_frequency", &AutoDeviceData::transmit_frequency_khz},
      Field{18, "start_angle", &AutoDeviceData::start_angle},
      Field{20, "stop_angle", &AutoDeviceData::stop_angle},
      Field{22, "num_steps", &AutoDeviceData::num_steps},
      Field{23, "delay", &AutoDeviceData::delay_ms},
      Field{24, "number_of_samples", &AutoDeviceData::number_of_samples},
  };
};

}  // namespace sonard::ping360
