// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/ping_log.hpp"

#include <fmt/format.h>

#include <boost/crc.hpp>
#include <chrono>

namespace sonard::client {

std::uint32_t samples_crc32(const gemini::ReceivedSamples& samples) {
  boost::crc_32_type crc;
  crc.process_bytes(samples.u8.data(), samples.u8.size());
  for (const std::uint16_t sample : samples.u16) {
    crc.process_byte(static_cast<unsigned char>(sample >> 8));
    crc.process_byte(static_cast<unsigned char>(sample & 0xFF));
  }
  return crc.checksum();
}

std::string ping_line(const gemini::ReceivedPing& ping, std::uint16_t sonar_id) {
  const double took_ms =
      std::chrono::duration<double, std::milli>(ping.finished - ping.first_datagram).count();
  return fmt::format(
      "ping number={} id={} transmit_us={} lines={} beams={} lines_lost={} lines_repaired={} retries={} "
      "took_ms={:.1f} "
      "crc32={:08x} sonar_id={}",
      ping.number, ping.head.ping_id & 0xFF, ping.head.transmit_time_us, ping.lines, ping.head.beams,
      ping.lines_lost, ping.lines_repaired, ping.retries.total(), took_ms, samples_crc32(ping.samples),
      sonar_id);
}

void PingRateMeter::add(TimePoint finished) {
  if (pings_++ == 0) {
    first_ = finished;
  }
  last_ = finished;
}

double PingRateMeter::hz() const {
  const double span_s = std::chrono::duration<double>(last_ - first_).count();
  return span_s > 0.0 ? static_cast<double>(pings_ - 1) / span_s : 0.0;
}

std::string summary_line(const gemini::LinkStatistics& statistics, const ProgramCounters& counters) {
  return fmt::format(
      "summary pings_complete={} pings_incomplete={} pings_missed={} pings_unrequested={} pings_abandoned={} "
      "lines_missing={} lines_repaired={} rate_hz={:.2f} retries={} retries_head={} retries_lines={} "
      "retries_tail={} "
      "configs_sent={} configs_repeated={} datagrams={} datagrams_bad={} dropped_rx={} dropped_tx={} "
      "kernel_drops={} "
      "reboots={} images_written={} images_skipped={} sonar_id={}",
      statistics.pings_complete, statistics.pings_incomplete, statistics.pings_missed,
      statistics.pings_unrequested, statistics.pings_abandoned, statistics.lines_missing,
      statistics.lines_repaired, counters.rate_hz, statistics.retries.total(), statistics.retries.head,
      statistics.retries.lines, statistics.retries.tail, statistics.configs_sent, statistics.configs_repeated,
      statistics.datagrams, statistics.bad_datagrams, counters.dropped_rx, counters.dropped_tx,
      counters.kernel_drops, statistics.reboots, counters.images_written, counters.images_skipped,
      counters.sonar_id);
}

}  // namespace sonard::client
