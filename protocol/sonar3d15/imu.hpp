// SPDX-License-Identifier: Apache-2.0
// The inertial sensor in a Sonar 3D-15, from its attitude. Source: protocol/sonar3d15/README.md 2.4.
#pragma once

#include <chrono>
#include <cstdint>

#include "protocol/common/noise.hpp"
#include "protocol/common/ping_job.hpp"
#include "protocol/sonar3d15/codec.hpp"
#include "protocol/sonar3d15/device_config.hpp"

namespace sonard::sonar3d15 {

inline constexpr std::chrono::milliseconds imu_period{10};

/// A batch of samples 10 ms apart. The specific force is that of gravity alone, because readings have no
/// acceleration; x forward, y to starboard, z down. The attitude turns evenly between the two readings.
/// @param sequence number of the batch
/// @param samples in the batch, at least 1
/// @param utc time of the last sample, since 1970
/// @param before a reading `span` before `now`
/// @param now the reading at `utc`
/// @param span 0: the head does not turn
ImuBatch make_imu_batch(std::uint32_t sequence, int samples, std::chrono::nanoseconds utc,
                        const SensorReadings& before, const SensorReadings& now,
                        std::chrono::nanoseconds span);

/// Adds the noise of the configuration to each sample.
void add_noise(const DeviceConfig& config, Noise& noise, ImuBatch& batch);

/// A batch of the first `size` samples of `waiting`, which has as many; they are removed from there.
ImuBatch take_batch(std::uint32_t sequence, int size, ImuBatch& waiting);

/// Sets a message of Protobuf to a time since 1970.
google::protobuf::Timestamp timestamp_of(std::chrono::nanoseconds utc);

}  // namespace sonard::sonar3d15
