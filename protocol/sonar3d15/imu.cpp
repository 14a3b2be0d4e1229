// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/imu.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonard::sonar3d15 {
namespace {

using std::chrono::nanoseconds;

constexpr double gravity_mps2 = 9.8;

void add(google::protobuf::RepeatedField<float>& numbers, double x, double y, double z) {
  for (const double number : {x, y, z}) {
    numbers.Add(static_cast<float>(number));
  }
}

}  // namespace

google::protobuf::Timestamp timestamp_of(nanoseconds utc) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(utc);
  google::protobuf::Timestamp stamp;
  stamp.set_seconds(seconds.count());
  stamp.set_nanos(static_cast<std::int32_t>((utc - seconds).count()));
  return stamp;
}

ImuBatch make_imu_batch(std::uint32_t sequence, int samples, nanoseconds utc, const SensorReadings& before,
                        const SensorReadings& now, nanoseconds span) {
  const double span_s = std::chrono::duration<double>(span).count();
  const double per_s = span_s > 0.0 ? 1.0 / span_s : 0.0;
  const double turn = std::remainder(now.heading_rad - before.heading_rad, 2.0 * std::numbers::pi) * per_s;
  const double nod = (now.pitch_rad - before.pitch_rad) * per_s;
  const double tilt = std::remainder(now.roll_rad - before.roll_rad, 2.0 * std::numbers::pi) * per_s;
  ImuBatch batch;
  batch.set_batch_sequence_id(sequence);
  batch.set_samples(static_cast<std::uint32_t>(samples));
  for (int i = samples - 1; i >= 0; --i) {
    const nanoseconds age = i * nanoseconds{imu_period};
    *batch.add_timestamps() = timestamp_of(utc - age);
    const double ago_s = std::min(std::chrono::duration<double>(age).count(), span_s);
    const double pitch = now.pitch_rad - nod * ago_s, roll = now.roll_rad - tilt * ago_s;
    add(*batch.mutable_specific_force(), gravity_mps2 * std::sin(pitch),
        -gravity_mps2 * std::sin(roll) * std::cos(pitch), -gravity_mps2 * std::cos(roll) * std::cos(pitch));
    add(*batch.mutable_rate_of_turn(), tilt - turn * std::sin(pitch),
        nod * std::cos(roll) + turn * std::sin(roll) * std::cos(pitch),
        turn * std::cos(roll) * std::cos(pitch) - nod * std::sin(roll));
  }
  return batch;
}

void add_noise(const DeviceConfig& config, Noise& noise, ImuBatch& batch) {
  const auto add_to = [&noise](google::protobuf::RepeatedField<float>& numbers, double deviation) {
    for (float& number : numbers) {
      number += deviation > 0.0 ? static_cast<float>(deviation * noise.next()) : 0.0F;
    }
  };
  add_to(*batch.mutable_specific_force(), config.imu_force_noise_mps2);
  add_to(*batch.mutable_rate_of_turn(), config.imu_rate_noise_radps);
}

ImuBatch take_batch(std::uint32_t sequence, int size, ImuBatch& waiting) {
  ImuBatch batch;
  batch.set_batch_sequence_id(sequence);
  batch.set_samples(static_cast<std::uint32_t>(size));
  for (int i = 0; i < size; ++i) {
    *batch.add_timestamps() = waiting.timestamps(i);
  }
  waiting.mutable_timestamps()->DeleteSubrange(0, size);
  const auto take = [size](google::protobuf::RepeatedField<float>& from,
                           google::protobuf::RepeatedField<float>& to) {
    to.Add(from.begin(), from.begin() + 3 * size);
    from.erase(from.begin(), from.begin() + 3 * size);
  };
  take(*waiting.mutable_specific_force(), *batch.mutable_specific_force());
  take(*waiting.mutable_rate_of_turn(), *batch.mutable_rate_of_turn());
  return batch;
}

}  // namespace sonard::sonar3d15
