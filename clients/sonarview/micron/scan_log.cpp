// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/micron/scan_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/crc.hpp>

#include "protocol/micron/units.hpp"

namespace sonard::client {

std::string scan_text(const micron::ScanSettings& settings) {
  const int left = settings.sector ? settings.sector->left : 0;
  const int right = settings.sector ? settings.sector->right : micron::units_per_turn;
  const int width = settings.sector ? micron::wrapped(right - left) : micron::units_per_turn;
  return fmt::format(
      "scan range_m={:.3f} bins={} bin_m={:.5f} ad_interval={} step={} step_deg={:g} from_deg={:g} "
      "to_deg={:g} "
      "lines_per_turn={} gain={} bits={} sound_speed_mps={:g}",
      micron::covered_range_m(settings), settings.bins, micron::bin_length_m(settings),
      micron::ad_interval(settings), settings.step, settings.step * 360.0 / micron::units_per_turn,
      micron::bearing_deg(left), settings.sector ? micron::bearing_deg(right) : 180.0,
      (width + settings.step - 1) / settings.step + (settings.sector ? 1 : 0),
      micron::make_head_command(settings).gain[0], settings.eight_bit ? 8 : 4, settings.sound_speed_mps);
}

std::string line_text(const micron::ReceivedLine& line, std::uint64_t sweep, double bin_m) {
  const auto strongest = std::max_element(line.bins.begin(), line.bins.end());
  boost::crc_32_type crc;
  crc.process_bytes(line.bins.data(), line.bins.size());
  return fmt::format(
      "line number={} turn={} bearing={} bearing_deg={:.5g} sweep={} bins={} strongest={} strongest_m={:.3f} "
      "crc32={:08x}",
      line.number, sweep, line.head.bearing, micron::bearing_deg(line.head.bearing),
      static_cast<int>(line.head.sweep), line.bins.size(), *strongest,
      (static_cast<double>(strongest - line.bins.begin()) + 0.5) * bin_m, crc.checksum());
}

std::string summary_text(const micron::ClientStatistics& statistics, std::uint64_t sweeps,
                         std::uint64_t lines_missed, const RunCounters& counters) {
  return fmt::format(
      "summary turns={} lines={} lines_missed={} rate_hz={:.2f} requests={} timeouts={} head_commands={} "
      "reboots={} motor_errors={} lines_unmatched={} lines_unrequested={} frames={} frames_bad={} "
      "frames_of_others={} bytes_dropped={} alives={} reconnects={} images_written={} images_skipped={}",
      sweeps, statistics.lines, lines_missed, counters.rate_hz, statistics.requests, statistics.timeouts,
      statistics.head_commands, statistics.reboots, statistics.motor_errors, statistics.lines_unmatched,
      statistics.lines_unrequested, statistics.frames, statistics.bad_frames, statistics.other_nodes,
      statistics.dropped_bytes, statistics.alives, counters.reconnects, counters.images_written,
      counters.images_skipped);
}

}  // namespace sonard::client
