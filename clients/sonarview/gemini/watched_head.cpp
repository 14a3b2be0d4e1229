// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/watched_head.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "protocol/common/endpoint.hpp"
#include "protocol/gemini/bearings.hpp"

namespace sonard::client {
namespace {

/// Each of several heads has a folder of its own.
std::filesystem::path folder_of(const GeminiOptions& options, std::size_t number) {
  const bool alone = options.run.out.empty() || options.sonar_ids.size() == 1;
  return alone ? options.run.out : options.run.out / std::to_string(options.sonar_ids[number]);
}

/// CRC-32 (zlib's polynomial) of the samples; 16-bit samples are big-endian.
std::uint32_t crc32_of(const gemini::ReceivedSamples& samples) {
  boost::crc_32_type crc;
  crc.process_bytes(samples.u8.data(), samples.u8.size());
  for (const std::uint16_t sample : samples.u16) {
    crc.process_byte(static_cast<unsigned char>(sample >> 8));
    crc.process_byte(static_cast<unsigned char>(sample & 0xFF));
  }
  return crc.checksum();
}

/// @param sound_speed_mps sound speed of the ranges that the user set
FanPing picture_of(gemini::ReceivedPing& ping, double sound_speed_mps) {
  picture::FanShape shape;
  shape.bearings_rad = gemini::bearings_rad(ping.head.beams);
  shape.lines = ping.lines;
  shape.line_step_m = sound_speed_mps / (2.0 * gemini::line_rate_hz) * (1 << ping.head.compression_log2());
  const cv::Mat samples = ping.head.eight_bit()
                              ? cv::Mat(ping.lines, ping.head.beams, CV_8UC1, ping.samples.u8.data())
                              : cv::Mat(ping.lines, ping.head.beams, CV_16UC1, ping.samples.u16.data());
  return {.shape = shape,
          .samples = samples.clone(),
          .caption = fmt::format("Gemini 720i  #{}   ping {}   {:.3f} s   {:.1f} m{}",
                                 ping.head.header.sonar_id, ping.head.ping_id & 0xFF,
                                 static_cast<double>(ping.head.transmit_time_us) * 1e-6, shape.range_m(),
                                 ping.complete() ? "" : fmt::format("   {} lines lost", ping.lines_lost))};
}

}  // namespace

WatchedHead::WatchedHead(const GeminiOptions& options, std::size_t number, GeminiSockets& sockets)
    : options_(options),
      sonar_id_(options.sonar_ids[number]),
      sockets_(sockets),
      run_(options.run, folder_of(options, number),
           options.sonar_ids.size() > 1 ? fmt::format("sonarview: {}: ", sonar_id_) : "sonarview: "),
      client_({.sonar_id = sonar_id_, .head_address = options.head_address}),
      pictures_(options.run),
      drop_rx_(options.drop_rx, 2 * options.seed + 2 * number),
      drop_tx_(options.drop_tx, 2 * options.seed + 2 * number + 1) {
  run_.say(fmt::format("waiting up to {:.1f} s for the status packet of {} on UDP port {}",
                       in_seconds(options_.run.wait),
                       sonar_id_ != 0 ? fmt::format("head {}", sonar_id_) : "a head", gemini::client_port));
  client_.start(run_.started(), make_ping_config(options_.settings), options_.run.pings);
}

void WatchedHead::on_datagram(TimePoint at, std::span<const std::uint8_t> datagram) {
  if (!ended_ && !drop_rx_.drop()) {
    client_.on_datagram(at, datagram);
  }
}

void WatchedHead::advance(TimePoint at) {
  if (ended_) {
    return;
  }
  if (client_.head()) {
    sockets_.open_towards(client_.head()->address);
  }
  client_.advance(at);
  send_commands();
  for (gemini::ReceivedPing& ping : client_.take_pings()) {
    take_ping(std::move(ping));
  }
  if (client_.head() && !run_.met()) {
    run_.meet(at);
    greet();
  }
  if (const auto fresh = run_.fresh_pings(at)) {
    const gemini::LinkStatistics& statistics = client_.statistics();
    run_.say(fmt::format("{} pings, {} in the last second; {} lines repaired, {} missing",
                         run_.counters().pings, *fresh, statistics.lines_repaired, statistics.lines_missing));
    if (ImageWriter* const writer = run_.writer()) {
      pictures_.refresh(*writer);
    }
  }
  check_limits(at);
}

void WatchedHead::send_commands() {
  for (const gemini::ClientDatagram& datagram : client_.take_outgoing()) {
    if (drop_tx_.drop()) {
      continue;
    }
    if (const auto error = sockets_.send(datagram.to, datagram.bytes);
        error && !std::exchange(send_failed_, true)) {
      run_.warn(fmt::format("cannot send to {}:{}: {}", address_text(datagram.to), gemini::head_port,
                            error.message()));
    }
  }
}

void WatchedHead::take_ping(gemini::ReceivedPing ping) {
  run_.count_ping(ping.finished);
  if (options_.run.log_pings) {
    fmt::print(
        "ping number={} id={} transmit_us={} lines={} beams={} lines_lost={} lines_repaired={} retries={} "
        "took_ms={:.1f} crc32={:08x} sonar_id={}\n",
        ping.number, ping.head.ping_id & 0xFF, ping.head.transmit_time_us, ping.lines, ping.head.beams,
        ping.lines_lost, ping.lines_repaired, ping.retries.total(),
        1e3 * in_seconds(ping.finished - ping.first_datagram), crc32_of(ping.samples),
        client_.head()->status.sonar_id);
    std::fflush(stdout);
  }
  if (ImageWriter* const writer = run_.writer()) {
    pictures_.take(*writer, picture_of(ping, options_.settings.sound_speed_mps), ping.number);
  }
}

void WatchedHead::check_limits(TimePoint at) {
  const HeadRun::Limit limit = run_.limit(at, true);
  if (client_.finished() || limit == HeadRun::Limit::duration) {
    end();
  } else if (limit == HeadRun::Limit::no_head) {
    give_up(ExitStatus::no_head, no_head_text());
  } else if (limit == HeadRun::Limit::no_ping) {
    give_up(ExitStatus::incomplete, no_ping_text());
  }
}

void WatchedHead::give_up(ExitStatus failure, const std::string& why) {
  run_.fail(failure, why);
  end();
}

void WatchedHead::end() {
  if (!std::exchange(ended_, true)) {
    client_.stop();
    send_commands();
  }
}

TimePoint WatchedHead::next_wake() const {
  const TimePoint limit = run_.next_wake(true);
  return std::min(limit, client_.next_deadline().value_or(limit));
}

// ---- Messages

void WatchedHead::greet() const {
  const gemini::Status& status = client_.head()->status;
  const Ipv4 address = client_.head()->address;
  const Ipv4 own = sockets_.own();
  run_.say(fmt::format("head {} at {}, netmask {}, firmware {:#06x}", status.sonar_id, address_text(address),
                       address_text(status.subnet_mask), status.firmware_version));
  const auto own_mask = interface_netmask(own);
  const bool same_network = ((address ^ own) & status.subnet_mask) == 0;
  if (!same_network || (own_mask && *own_mask != status.subnet_mask)) {
    run_.warn(fmt::format(
        "warning: {} with netmask {} and {} with netmask {} are not on one network; later libraries of the "
        "vendor would send nothing",
        address_text(address), address_text(status.subnet_mask), address_text(own),
        own_mask ? address_text(*own_mask) : "unknown"));
  }
}

std::string WatchedHead::no_head_text() const {
  std::string advice =
      "check that sonard runs, that it sends its status to this address or broadcasts it on this network, "
      "and that no firewall blocks UDP";
  if (const auto& others = client_.other_heads(); !others.empty()) {
    std::string received;
    for (const auto& [id, address] : others) {
      received += fmt::format("{}head {} at {}", received.empty() ? "" : ", ", id, address_text(address));
    }
    advice = fmt::format("only {} sent a status (to view one, use --sonar-id {})", received,
                         others.begin()->first);
  }
  return fmt::format("no status{} on port {} within {:.1f} s: {}",
                     sonar_id_ != 0 ? fmt::format(" of head {}", sonar_id_) : "", gemini::client_port,
                     in_seconds(options_.run.wait), advice);
}

std::string WatchedHead::no_ping_text() const {
  const gemini::HeadInfo& head = *client_.head();
  return fmt::format(
      "the head sends its status, but no ping for {:.1f} s: check that it can be reached at {}:{} from {}, "
      "and that it has a pose{}",
      in_seconds(options_.run.ping_wait), address_text(head.address), gemini::head_port,
      address_text(sockets_.own()),
      head.address == head.status.alternate_ip
          ? ""
          : fmt::format(". Its status gives the address {} (to use it, omit --head)",
                        address_text(head.status.alternate_ip)));
}

ExitStatus WatchedHead::sum_up() {
  if (ImageWriter* const writer = run_.writer()) {
    pictures_.finish(*writer);
  }
  run_.finish();
  const gemini::LinkStatistics& link = client_.statistics();
  const RunCounters& run = run_.counters();
  fmt::print(
      "summary pings_complete={} pings_incomplete={} pings_missed={} pings_unrequested={} pings_abandoned={} "
      "lines_missing={} lines_repaired={} rate_hz={:.2f} retries={} retries_head={} retries_lines={} "
      "retries_tail={} configs_sent={} configs_repeated={} datagrams={} datagrams_bad={} dropped_rx={} "
      "dropped_tx={} kernel_drops={} reboots={} images_written={} images_skipped={} sonar_id={}\n",
      link.pings_complete, link.pings_incomplete, link.pings_missed, link.pings_unrequested,
      link.pings_abandoned, link.lines_missing, link.lines_repaired, run.rate_hz, link.retries.total(),
      link.retries.head, link.retries.lines, link.retries.tail, link.configs_sent, link.configs_repeated,
      link.datagrams, link.bad_datagrams, drop_rx_.dropped(), drop_tx_.dropped(), sockets_.kernel_drops(),
      link.reboots, run.images_written, run.images_skipped,
      client_.head() ? client_.head()->status.sonar_id : sonar_id_);
  std::fflush(stdout);
  return run_.status(link.pings_complete > 0 && link.pings_incomplete == 0);
}

}  // namespace sonard::client
