#include "protocol/micron/line_job.hpp"

#include "protocol/micron/line_timing.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::micron {

MicronJob make_line_job(const HeadCommand& parameters, const DeviceConfig& config, int bearing) {
  MicronJob job;
  job.bearing = static_cast<std::uint16_t>(bearing);
  const bool mirrored = parameters.has(control_bits::invert) != config.mounted_inverted;
  job.bearing_rad = (mirrored ? -1.0 : 1.0) * bearing_rad(bearing);
  job.bins = effective_bins(parameters);
  job.bin_time_s = bin_time_s(effective_ad_interval(parameters));
  job.sound_speed_mps = config.water_sound_speed_mps;
  job.bin_length_m = job.bin_time_s * job.sound_speed_mps / 2.0;
  job.gain_db = gain_db(parameters.gain[0]);
  job.ad_low_db = level_db(parameters.ad_low);
  job.ad_span_db = level_db(parameters.ad_span);
  job.eight_bit = parameters.has(control_bits::eight_bit);
  job.transmit = !parameters.has(control_bits::transmit_off);
  return job;
}

}  // namespace sonard::micron
