#include "protocol/micron/line_job.hpp"

#include <algorithm>

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

MicronJob make_line_job(const RecordedLine& recorded) {
  const HeadData& line = recorded.line;
  MicronJob job;
  job.bearing = line.bearing;
  job.bearing_rad = recorded.bearing_rad;
  job.bins = recorded.bins;
  job.bin_time_s = bin_time_s(std::max<int>(line.ad_interval, 1));
  job.sound_speed_mps = recorded.sound_speed_mps;
  job.bin_length_m = job.bin_time_s * job.sound_speed_mps / 2.0;
  job.gain_db = gain_db(line.gain);
  job.ad_low_db = level_db(line.ad_low);
  job.ad_span_db = level_db(line.ad_span);
  job.eight_bit = line.eight_bit();
  job.transmit = (line.control & control_bits::transmit_off) == 0;
  job.record = recorded.record;
  return job;
}

}  // namespace sonard::micron
