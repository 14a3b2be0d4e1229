// SPDX-License-Identifier: Apache-2.0
// Lines of a Micron as a client receives them: through the settings of a job, the receiver and the codec.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "protocol/micron/codec.hpp"
#include "renderer/acoustics/receiver.hpp"
#include "server/devices/micron/settings.hpp"
#include "server/devices/micron/type.hpp"
#include "server/heads/head_config.hpp"

namespace sonard::test {

/// A client in a world with the same echo everywhere.
class MicronClient {
 public:
  explicit MicronClient(const server::HeadConfig& head, double bin_m = 0.05, int bin_count = 500)
      : gain_db(server::device_settings<server::MicronConfig>(head).nominal_gain_db),
        head_(head),
        bin_m_(bin_m),
        bins_(bin_count) {}

  double gain_db;  ///< of the client; 80 dB are 100 %

  /// The next line, decoded.
  std::vector<std::uint8_t> line(float intensity, bool transmit = true, double bearing_rad = 0) {
    PingJob job;
    job.bearing_rad = bearing_rad;
    job.native_bins = bins_;
    job.native_bin_m = bin_m_;
    job.sound_speed_mps = 1500;
    job.gain_db = gain_db;
    job.transmit = transmit;
    render::PingRequest request;
    request.settings = server::micron_sonar_settings(job, head_);
    request.T_world_sonar = server::T_world_transducer({}, job.bearing_rad);
    request.ping_number = ping_number_++;
    request.seed = 3;
    const render::EchoImage echo{1, bins_, std::vector<float>(static_cast<std::size_t>(bins_), intensity)};
    const std::vector<std::uint8_t> samples = receiver_.receive(echo, request, 0, *workers_).u8;
    micron::HeadData sent;
    sent.control = micron::control_bits::eight_bit;
    sent.data = samples;
    const std::vector<std::uint8_t> frame = micron::encode(micron::Report{sent});
    const auto report = micron::decode_report(frame);
    const auto& received = std::get<micron::HeadData>(*report);
    return {received.data.begin(), received.data.end()};
  }

 private:
  server::HeadConfig head_;
  double bin_m_;
  int bins_;
  render::Receiver receiver_;
  std::unique_ptr<render::WorkerPool> workers_ = std::make_unique<render::WorkerPool>(1);
  std::uint64_t ping_number_ = 0;
};

inline double decibels_of(std::uint8_t code) {
  return std::ceil(code * 160 / 255.0) / 2;  // inverse of code = floor(k 255 / 160), k half decibels
}

}  // namespace sonard::test
