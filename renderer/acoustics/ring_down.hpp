// SPDX-License-Identifier: Apache-2.0
// The transducer's own ringing after the pulse (docs/physics.md 2.16).
#pragma once

#include <vector>

#include "renderer/acoustics/random.hpp"
#include "renderer/physical_model.hpp"
#include "renderer/range_bins.hpp"

namespace sonard::render {

/// Amplitude of the ring-down per range bin, before TVG. It rises as a half cosine from 0 at half the peak's
/// range to the peak; with RingDown::from_start it is constant behind the TVG up to the peak. From the peak
/// to the end it falls by 80 dB, linearly in dB, and continues with that slope.
std::vector<float> ring_down_amplitudes(const PhysicalModel& model, const RangeBins& range);

/// Mean intensity per range bin, before TVG, of echoes from the vehicle itself, from the ring-down's peak on.
std::vector<float> vehicle_reverberation(const RingDown& ring_down, const RangeBins& range);

/// The first range bin beyond the end of the ring-down; 0 without ring-down.
int ring_down_bins(const RingDown& ring_down, const RangeBins& range);

/// Factor of the ring-down's amplitude in one ping: its level in dB is normally distributed.
float draw_ring_down(const RingDown& ring_down, RandomKey key);

}  // namespace sonard::render
