#include <numbers>

#include "server/config/config.hpp"

namespace sonard::server {

// The errors of the elements stand for all that a real head has: they let as much leak as recordings show
// (docs/physics.md 2.16).
GeminiHeadConfig::GeminiHeadConfig() {
  constexpr double degree = std::numbers::pi / 180.0;
  acoustics.aperture.azimuth = render::Aperture::Azimuth::array;
  acoustics.aperture.element_amplitude_sd = 0.35;
  acoustics.aperture.element_phase_sd_rad = 20 * degree;
  acoustics.physical.pulse = render::PhysicalModel::Pulse::tone;
  // About one cell in a hundred is saturated where a bed fills the fan, as in recordings (the same).
  acoustics.physical.gain_db = 54.0;
  // Whether what sends and what hears share their height is not published: the pattern is taken once
  // (docs/physics.md 2.5).
  acoustics.aperture.elevation = render::Aperture::Elevation::sinc;
}

// Beam of docs/protocols/micron.md 10. Levels: a wall across the beam 5 m away comes to about 55 dB of the
// 80, the noise under the ceiling of the TVG to 5 dB, the ring-down to 60 dB, and one ping of fourteen is hit
// by interference, as recordings show (docs/physics.md 2.16).
MicronHeadConfig::MicronHeadConfig() {
  constexpr double degree = std::numbers::pi / 180.0;
  acoustics.aperture.beam_edges_rad = {1.5 * degree, -1.5 * degree};
  acoustics.aperture.receive_beamwidth_rad = 3 * degree;
  acoustics.aperture.vertical_beamwidth_rad = 35 * degree;
  acoustics.aperture.elevation = render::Aperture::Elevation::sinc_two_way;  // one transducer sends and hears
  acoustics.output_scale = render::OutputScale::half_decibels;
  acoustics.physical.pulse = render::PhysicalModel::Pulse::chirp;
  acoustics.physical.gain_db = -9.0;
  acoustics.physical.tvg_max_db = 75.0;
  acoustics.physical.noise_level_db = -141.0;
  acoustics.physical.near_field_blank_m = 0.1;
  acoustics.physical.ring_down.on = true;
  acoustics.physical.interference.probability = 0.07;
  acoustics.physical.broadside_stripe_db = 0.0;
}

}  // namespace sonard::server
