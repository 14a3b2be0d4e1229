// SPDX-License-Identifier: Apache-2.0
// The state of a Device. Private to device.cpp, which has clients, pings and time, and commands.cpp.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "protocol/common/once_warnings.hpp"
#include "protocol/common/ping_cycle.hpp"
#include "protocol/dvl_a50/clock.hpp"
#include "protocol/dvl_a50/codec.hpp"
#include "protocol/dvl_a50/dead_reckoning.hpp"
#include "protocol/dvl_a50/device.hpp"
#include "protocol/dvl_a50/measurement.hpp"
#include "protocol/dvl_a50/recorded_form.hpp"

namespace sonard::dvl_a50 {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

inline constexpr milliseconds position_period{200};
inline constexpr nanoseconds least_period{milliseconds{1}};

inline SharedBytes bytes_of(std::string_view text) {
  return SharedBytes(std::vector<std::uint8_t>(text.begin(), text.end()));
}

inline nanoseconds travel_time(double way_m, double speed_mps) {
  return nanoseconds{std::llround(1e9 * std::clamp(way_m / speed_mps, 0.0, 100.0))};
}

class Device::Impl {
 public:
  Impl(const DeviceConfig& config, TimePoint start)
      : config_(validated(config)),
        settings_(config.settings),
        serial_output_(config.serial_output),
        clock_(config.unix_offset, config.ntp_synced, start),
        noise_(config.seed),
        dead_reckoning_(
            {config.heading_drift_deg_per_min * std::numbers::pi / 180.0 / 60.0, config.position_noise_m},
            config.seed + 1),
        cycle_({.simulated_time = config.simulated_time, .plays_back = config.plays_back}, start, counters_),
        position_due_(start + position_period),
        next_cycling_(start + config.cycling_interval) {}

  // One overload for each event.
  void take(TimePoint, const TimePassed&) {}
  void take(TimePoint now, const BytesReceived& piece);
  void take(TimePoint, const ClientCame& came) { client_of(came.who); }
  void take(TimePoint, const ClientGone& gone) { forget(gone.who); }
  void take(TimePoint now, const PingRendered& ping);
  void take(TimePoint now, const PingNotRendered& ping) { cycle_.on_image_failed(now, ping.number); }
  void take(TimePoint, const TriggerEdge&) {}   // the device has no trigger input
  void take(TimePoint, const WaterChanged&) {}  // in air there are no echoes
  void take(TimePoint now, const SensorsRead& sensors);
  void take(TimePoint, const PingFed& feed) {
    cycle_.feed(feed.ping && recorded_form(feed.ping->wire) ? feed.ping : std::nullopt);
  }
  void take(TimePoint, const NextPingDue&) { cycle_.grant(); }

  void advance(TimePoint now);
  Actions actions(TimePoint now);

  const DeviceCounters& counters() const { return counters_; }
  std::vector<Counter> counts() const;

 private:
  struct Client {
    Peer peer;
    JsonStream stream;    ///< of a JSON client
    std::string request;  ///< of an HTTP client
  };
  struct Delayed {
    TimePoint due{};
    Peer peer;
    SharedBytes bytes;
  };
  struct Pending {
    TimePoint due{};
    Velocity report;
  };
  /// The ping under way.
  struct Ping {
    PingPlan plan;
    bool triggered = false;
    std::optional<Velocity> recorded;
    Velocity report;                    ///< set at the arrival of the image
    std::vector<std::uint8_t> samples;  ///< of a recorded ping, as they came
  };
  /// What a command did.
  struct Outcome {
    std::string error = {};       ///< empty: success
    std::string result = "null";  ///< JSON, or a sentence for the serial line
    nanoseconds delay{0};         ///< of the answer
    bool understood = true;
  };
  struct Command {
    std::string_view name;
    Release since;
    Outcome (Impl::*run)(TimePoint now, const Json::Members& parameters);
  };
  struct SerialRule {
    std::string_view name;
    std::size_t least_options, most_options;
    Outcome (*run)(Impl& device, TimePoint now, const std::vector<std::string>& options);
  };

  // Clients.
  Client& client_of(const Peer& peer);
  void forget(const Peer& peer);
  bool heard() const;
  void send(const Peer& peer, SharedBytes bytes) {
    outgoing_.push_back({Outgoing::To::peer, peer, std::move(bytes)});
  }
  void send_to_channel(int channel, const SharedBytes& bytes);
  void send_json(std::string text) { send_to_channel(json_channel, bytes_of(text + config_.line_end)); }
  void send_serial(std::string_view text) { send(serial_peer(), bytes_of(fmt::format("{}\r\n", text))); }
  void answer(TimePoint now, const Peer& peer, std::string_view text, nanoseconds delay);
  Peer serial_peer() const { return {config_.serial_channel, {}, 0}; }
  std::string_view format() const { return texts_of(config_.release).format; }

  // Input.
  void take_json(TimePoint now, Client& client, const SharedBytes& bytes);
  void take_object(TimePoint now, const Peer& peer, const std::string& text);
  void take_serial(TimePoint now, const SharedBytes& bytes);
  void take_line(TimePoint now, const std::string& line);
  void take_http(Client& client, const SharedBytes& bytes);
  void refuse(std::string_view subject, std::string text);

  // Commands.
  static const std::vector<Command>& commands();
  static const std::vector<SerialRule>& serial_rules();
  Outcome reset(TimePoint now, const Json::Members&);
  Outcome calibrate(TimePoint, const Json::Members&);
  Outcome trigger(TimePoint, const Json::Members&);
  Outcome get_config(TimePoint, const Json::Members&);
  Outcome set_config(TimePoint, const Json::Members& parameters);
  Outcome get_version(TimePoint, const Json::Members&) { return {{}, version_text()}; }
  Outcome set_ntp(TimePoint, const Json::Members& parameters);
  Outcome get_ntp(TimePoint, const Json::Members&);
  Outcome set_time(TimePoint now, const Json::Members& parameters);
  Outcome get_time(TimePoint now, const Json::Members&) { return {{}, clock_.status_json(now)}; }
  Outcome force_sync(TimePoint now, const Json::Members& parameters);
  void use(const Settings& settings);
  std::string version_text() const;
  Outcome set_time(TimePoint now, std::optional<std::int64_t> unix_us);
  Outcome set_serial_output(const std::string& option);
  Outcome set_serial_settings(const std::vector<std::string>& options);

  // Pings and reports.
  bool pinging() const { return heard() && (settings_.acoustic_enabled || triggers_ > 0); }
  PingPlan plan() const { return plan_ping(mode_, config_, settings_); }
  nanoseconds period(const PingPlan& plan) const {
    return std::max(ping_period(plan, config_), least_period);
  }
  nanoseconds listening_time(const PingPlan& plan) const {
    return travel_time(2.0 * plan.range_m, config_.water_sound_speed_mps);
  }
  std::optional<TimePoint> next_start() const;
  std::optional<TimePoint> image_due() const;
  void begin_ping(TimePoint now);
  void finish_ping(TimePoint now);
  void report(TimePoint now, Velocity velocity);
  void report_position(TimePoint now);
  void move(TimePoint now);

  const DeviceConfig config_;
  DeviceCounters counters_;
  Settings settings_;
  int serial_output_;
  std::vector<Client> clients_;
  std::string line_;                     ///< of the serial line, unfinished
  std::optional<TimePoint> line_until_;  ///< the patience with it
  std::vector<Delayed> delayed_;
  Clock clock_;

  Noise noise_;
  DeadReckoning dead_reckoning_;
  std::optional<SensorReadings> readings_;
  std::optional<int> mode_;  ///< with bottom lock
  bool locked_ = false;
  int triggers_ = 0;
  PingCycle cycle_;
  Ping ping_;
  std::deque<Pending> pending_;
  TimePoint position_due_, next_cycling_;
  TimePoint next_ping_{};  ///< by the rate
  TimePoint wanted_{};     ///< since when pings are wanted
  TimePoint last_start_{};
  std::optional<TimePoint> reported_at_;
  bool was_pinging_ = false;

  // Of the step in progress.
  std::vector<Outgoing> outgoing_;
  std::vector<Peer> disconnect_;
  std::vector<Notice> notices_;
  OnceWarnings warnings_;
};

}  // namespace sonard::dvl_a50
