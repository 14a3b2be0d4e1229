// SPDX-License-Identifier: Apache-2.0
// The transducer's own ringing after the pulse (docs/physics.md 2.16).
#pragma once

#include <vector>

#include "renderer/acoustics/random.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Amplitude of the ring-down per range bin, before TVG: from nothing at half of the peak's range up to the
/// peak as a half cosine, or, RingDown::from_start, even behind the TVG up to the peak; and from there by 80
/// dB down to the end, straight in dB and so on beyond.
std::vector<float> ring_down_amplitudes(const PhysicalModel& model, const RangeLines& range);

/// Mean intensity per range bin, before TVG, of what the vehicle sends back behind the ring-down.
std::vector<float> vehicle_reverberation(const RingDown& ring_down, const RangeLines& range);

/// The first range bin beyond the end; 0: there is no ring-down.
int ring_down_lines(const RingDown& ring_down, const RangeLines& range);

/// Factor of the ring-down's amplitude in one ping: its level in dB is normally distributed.
float draw_ring_down(const RingDown& ring_down, RandomKey key);

}  // namespace sonard::render
