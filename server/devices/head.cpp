// SPDX-License-Identifier: Apache-2.0
#include "server/devices/head.hpp"

#include <algorithm>
#include <deque>
#include <new>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/devices/device_type.hpp"
#include "server/devices/directions.hpp"
#include "server/devices/head_diagnosis.hpp"
#include "server/devices/head_log.hpp"
#include "server/devices/head_poses.hpp"
#include "server/devices/head_rendering.hpp"
#include "server/devices/head_status.hpp"
#include "server/devices/ping_viewer.hpp"
#include "server/devices/playback.hpp"
#include "server/devices/recent_activity.hpp"
#include "server/net/deadline_timer.hpp"
#include "server/net/interfaces.hpp"
#include "server/pose/pose_history.hpp"
#include "server/program_log/peer_log.hpp"
#include "server/recording/head_recording.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::seconds report_period{10};
constexpr std::chrono::milliseconds pause_without_memory{100};
constexpr std::size_t most_waiting_events = 4096;  // while a transport is blocked; more are dropped
constexpr std::chrono::milliseconds sense_period{50};

/// Poses of the newest job, for recording and viewers: its ping goes onto the wire before the next job comes.
struct PosesOfJob {
  std::uint64_t number = 0;
  std::shared_ptr<const PosesUsed> poses;
};

}  // namespace

struct Head::Impl : std::enable_shared_from_this<Head::Impl> {
  Impl(const HeadConfig& head_config, int head_index, const HeadServices& services);

  const HeadConfig config;
  const int index;  ///< among all heads
  const Clock& clock;
  const PoseHistory& history;
  const std::optional<double> water_surface_z_m;
  Playback* const playback;
  PingViewer* const viewer;
  const DeviceType& type;

  std::unique_ptr<ConnectedDevice> connected;
  HeadPoses poses;
  HeadRendering rendering;
  DeadlineTimer timer;
  asio::steady_timer report_timer;
  HeadLog log;
  HeadRecording recording;
  PosesOfJob newest_job;
  RecentClients clients;
  RecentPings recent_pings;
  std::optional<NewestPing> newest;
  HeadDiagnosis diagnosis;
  OwnAddresses own_addresses;
  PeerLog address_log;

  std::deque<Event> events;  ///< not processed yet
  std::optional<TimePoint> wake_at;
  std::optional<NextPing> next_ping;
  std::optional<TimePoint> sensed_at;  ///< PoseHistory::present() of the newest sense()
  bool out_of_water = false;
  SensorReadings readings;  ///< last sent to the device
  bool running = false;
  bool pumping = false;

  void start();
  void stop();
  TransportEvents transport_events();
  HeadCounts counts() const;
  HeadStatus status() const;
  void look_at_addresses(const std::vector<InterfaceAddress>& now);
  std::vector<Finding> findings() const;

  void happen(Event event);
  void pump();
  void take_or_lose(TimePoint now, const Event& event);
  template <typename Work>
  bool done_or_lost(const Work& work);
  void take(TimePoint now, const Event& event);
  void step(TimePoint now, const Event& event);
  std::optional<std::uint64_t> carry_out(TimePoint now, Actions actions);
  void send(std::vector<Outgoing> messages);
  void record(TimePoint now, PingRecord ping);
  void sense(TimePoint now);
  void read_sensors(TimePoint now, TimePoint present, const render::Pose& T_world_mount);
  void note_water(TimePoint now, const std::optional<render::Pose>& T_world_mount);
  void feed(TimePoint now);
  bool next_ping_is_due(TimePoint now);
  bool render(const PingJob& job);
  PosedPing posed(const PingJob& job, std::shared_ptr<const PosesUsed> poses_of_ping) const;
  void schedule(TimePoint now);
  void report_every_period();
};

Head::Head(const HeadConfig& config, int index, const HeadServices& services)
    : impl_(std::make_shared<Impl>(config, index, services)) {}

Head::~Head() {
  impl_->stop();
}

void Head::start() {
  impl_->start();
}
void Head::stop() {
  impl_->stop();
}
void Head::poses_changed() {
  if (impl_->history.ping_clock() != PingClock::wall) {
    impl_->happen(TimePassed{});
  }
}
std::optional<std::chrono::nanoseconds> Head::pose_lead() const {
  return impl_->poses.lead();
}
void Head::look_at_addresses(const std::vector<InterfaceAddress>& now) {
  impl_->look_at_addresses(now);
}
HeadStatus Head::status() const {
  return impl_->status();
}
ConnectedDevice& Head::connected() {
  return *impl_->connected;
}
const RenderCounters& Head::render_counters() const {
  return impl_->rendering.counters();
}

Head::Impl::Impl(const HeadConfig& head_config, int head_index, const HeadServices& services)
    : config(head_config),
      index(head_index),
      clock(services.clock),
      history(services.poses),
      water_surface_z_m(services.water_surface_z_m),
      playback(services.playback),
      viewer(services.viewer),
      type(type_of(config)),
      connected(type.connect(config, services.io, clock)),
      poses(config, history, services.vehicle_model),
      rendering(config, index, services.renderer, clock,
                // If poses bring the time, pings wait for them, and the image must depend on nothing else. A
                // recording is played as it is.
                {.adapts = !poses.in_simulated_time() && playback == nullptr,
                 .withdraws = services.skip.on(render::SkipRule::nobody_listening)}),
      timer(services.io),
      report_timer(services.io),
      log(config.name),
      recording(services.recorder, index, clock),
      diagnosis(config, history, services.vehicle_model, services.world) {}

// ---- Life

void Head::Impl::start() {
  running = true;
  connected->transport().start(transport_events());
  for (const std::string& way : connected->transport().descriptions()) {
    spdlog::info("head={}: serves {}", config.name, way);
  }
  connected->start([weak = weak_from_this()](Event event) {
    if (const auto self = weak.lock()) {
      self->happen(std::move(event));
    }
  });
  report_every_period();
  happen(TimePassed{});
}

void Head::Impl::stop() {
  if (!std::exchange(running, false)) {
    return;
  }
  timer.cancel();
  report_timer.cancel();
  connected->stop();
  connected->transport().stop();
  log.totals(counts());
}

// Handlers hold the head weakly: a queued handler does nothing once the head is gone.
TransportEvents Head::Impl::transport_events() {
  const std::weak_ptr<Impl> weak = weak_from_this();
  const auto happens = [weak](auto event) {
    if (const auto self = weak.lock()) {
      self->happen(std::move(event));
    }
  };
  TransportEvents hooks{.received =
                            [weak](BytesReceived received) {
                              if (const auto self = weak.lock()) {
                                self->clients.sent(received.from.remote, self->clock.now());
                                self->happen(std::move(received));
                              }
                            },
                        .came =
                            [weak](const ClientCame& came) {
                              if (const auto self = weak.lock()) {
                                self->clients.sent(came.who.remote, self->clock.now());
                                self->happen(came);
                              }
                            },
                        .gone =
                            [weak](const ClientGone& gone) {
                              if (const auto self = weak.lock()) {
                                self->clients.gone(gone.who.remote);
                                self->happen(gone);
                              }
                            },
                        .writable = [happens] { happens(TimePassed{}); },
                        .notice =
                            [weak](const Notice& notice) {
                              if (const auto self = weak.lock()) {
                                self->log.notice(notice);
                              }
                            },
                        .passed = {},
                        .ended = {}};
  if (recording.on()) {  // copies: the hooks hold no reference to the head
    hooks.passed = [to = recording](WirePassed passed) { to.wire(std::move(passed)); };
    hooks.ended = [to = recording](const WireEnds& ends) { to.stream_ended(ends); };
  }
  return hooks;
}

HeadCounts Head::Impl::counts() const {
  return {rendering.counters(), connected->device().progress(), connected->device().counts(),
          connected->transport().counts()};
}

HeadStatus Head::Impl::status() const {
  const TimePoint now = clock.now();
  return {.name = config.name,
          .type = std::string(type.name()),
          .scanning = type.scanning(),
          .serves = connected->transport().descriptions(),
          .link_faults = connected->transport().faults(),
          .clients = clients.since(now - std::chrono::minutes{1}),
          .counts = counts(),
          .pings_per_s = recent_pings.per_s(now),
          .newest = newest,
          .spent = rendering.newest_seconds(),
          .latency = recent_pings.latency(),
          .since_last_ping = recent_pings.silence(now),
          .findings = findings()};
}

std::vector<Finding> Head::Impl::findings() const {
  std::vector<Finding> all = diagnosis.findings(clock.now());
  for (const Ipv4 address : own_addresses.gone()) {
    all.push_back(
        {"address_gone", fmt::format("The address {} is gone from this machine, so no client reaches the "
                                     "head there. Is the cable plugged in? Was the lease renewed?",
                                     address_text(address))});
  }
  return all;
}

void Head::Impl::look_at_addresses(const std::vector<InterfaceAddress>& now) {
  connected->follow_addresses(now);
  std::vector<Ipv4> own;
  if (auto moved = connected->own_addresses()) {
    own = std::move(*moved);
  } else {
    for (const PlannedSocket& socket : type.sockets(config)) {
      own.push_back(socket.endpoint.address);
    }
  }
  const OwnAddresses::News news = own_addresses.look(own, now);
  for (const Ipv4 address : news.gone) {
    address_log.warn(
        "head={}: its address {} is gone from this machine: no client reaches the head there until it is "
        "back (plug the cable in, or renew the lease)",
        config.name, address_text(address));
  }
  for (const Ipv4 address : news.back) {
    address_log.info("head={}: its address {} is back", config.name, address_text(address));
  }
}

// ---- Events

void Head::Impl::happen(Event event) {
  if (events.size() >= most_waiting_events && std::holds_alternative<BytesReceived>(event)) {
    log.notice({Notice::Level::warning,
                "drops commands of clients, because it cannot send answers (do the clients read?)"});
    return;
  }
  events.push_back(std::move(event));
  pump();
}

// Processes all queued events, including new ones that arrive meanwhile, and sleeps until the next one is
// due.
void Head::Impl::pump() {
  if (!running || std::exchange(pumping, true)) {
    return;
  }
  while (running && !events.empty() && !connected->transport().blocked()) {
    const Event event = std::move(events.front());
    events.pop_front();
    take_or_lose(clock.now(), event);
  }
  pumping = false;
  if (running) {
    schedule(clock.now());
  }
}

/// Runs work that may run out of memory. This head then loses that work, at most one ping; other heads are
/// not affected. @return false if the work was lost
template <typename Work>
bool Head::Impl::done_or_lost(const Work& work) {
  try {
    work();
    return true;
  } catch (const std::bad_alloc&) {
  }
  try {
    log.notice({Notice::Level::warning, "out of memory: a ping or an answer is lost"});
  } catch (const std::bad_alloc&) {
    // The log line is lost, too.
  }
  return false;
}

void Head::Impl::take_or_lose(TimePoint now, const Event& event) {
  if (done_or_lost([&] { take(now, event); })) {
    return;
  }
  wake_at = now + pause_without_memory;
  if (const auto* const rendered = std::get_if<PingRendered>(&event)) {
    done_or_lost([&] { step(now, PingNotRendered{rendered->image.number}); });
  }
}

void Head::Impl::take(TimePoint now, const Event& event) {
  sense(now);
  feed(now);
  step(now, event);
  while (next_ping_is_due(now)) {
    step(now, NextPingDue{});
  }
}

// Answers a ping that is impossible, or no longer wanted, at once. If the device renders ahead, it may
// request the next ping at once. The loop ends, because each iteration advances by a ping period or takes one
// overdue ping.
void Head::Impl::step(TimePoint now, const Event& event) {
  std::optional<std::uint64_t> not_rendered = carry_out(now, connected->device().step(now, event));
  while (not_rendered && running) {
    not_rendered = carry_out(now, connected->device().step(now, PingNotRendered{*not_rendered}));
  }
  connected->after_step();
}

// Returns the number of a job that gets no image. The device waits for an answer to its job, so the number is
// returned whatever else is lost.
std::optional<std::uint64_t> Head::Impl::carry_out(TimePoint now, Actions actions) {
  for (const Notice& notice : actions.notices) {
    log.notice(notice);
  }
  if (actions.misaddressed) {
    diagnosis.misaddressed(now, std::move(*actions.misaddressed));
  }
  if (actions.record) {
    done_or_lost([&] { record(now, std::move(*actions.record)); });
  }
  done_or_lost([&] { send(std::move(actions.send)); });
  for (const Peer& client : actions.disconnect) {
    connected->transport().disconnect(client);
  }
  wake_at = actions.wake_at;
  next_ping = actions.next_ping;
  if (actions.nobody_there) {
    poses.rest();
  }
  if (playback != nullptr) {
    playback->progress(index, now, connected->device().progress());
  }
  if (actions.cancelled && rendering.withdraw()) {
    return actions.cancelled;
  }
  bool rendered = true;
  if (actions.render && !(done_or_lost([&] { rendered = render(*actions.render); }) && rendered)) {
    return actions.render->number;
  }
  return std::nullopt;
}

void Head::Impl::send(std::vector<Outgoing> messages) {
  if (messages.empty()) {
    return;
  }
  for (const Outgoing& message : messages) {
    if (message.to == Outgoing::To::everybody) {
      recording.status(message.bytes);
    }
  }
  connected->transport().send(std::move(messages));
}

void Head::Impl::record(TimePoint now, PingRecord ping) {
  recent_pings.sent(now, ping.transmit_time);
  if (recording.on() && newest_job.poses && newest_job.number == ping.number) {
    recording.ping({ping, newest_job.poses});
  }
  if (viewer != nullptr) {
    viewer->show(std::make_shared<const ShownPing>(
        ShownPing{index, now, std::move(ping),
                  newest_job.poses ? std::optional(newest_job.poses->T_world_sonar) : std::nullopt}));
  }
}

// Looks at the pose of the present at each new pose in simulated time, else every sense_period: an event may
// be any datagram.
void Head::Impl::sense(TimePoint now) {
  if (!water_surface_z_m && !type.has_sensors()) {
    return;
  }
  const TimePoint present = history.present(now);
  if (sensed_at &&
      (poses.in_simulated_time() ? present == *sensed_at : present - *sensed_at < sense_period)) {
    return;
  }
  sensed_at = present;
  const std::optional<render::Pose> T_world_mount = poses.T_world_mount(present);
  note_water(now, T_world_mount);
  if (T_world_mount && type.has_sensors()) {
    read_sensors(now, present, *T_world_mount);
  }
}

void Head::Impl::read_sensors(TimePoint now, TimePoint present, const render::Pose& T_world_mount) {
  SensorReadings read = sensor_readings(T_world_mount, water_surface_z_m, poses.mount_velocity_mps(present));
  if (poses.in_simulated_time()) {
    read.simulated_time = present;
  }
  if (std::exchange(readings, read) != read) {
    step(now, SensorsRead{read});
  }
}

void Head::Impl::note_water(TimePoint now, const std::optional<render::Pose>& T_world_mount) {
  const bool out = water_surface_z_m && T_world_mount && T_world_mount->position_m.z > *water_surface_z_m;
  if (std::exchange(out_of_water, out) == out) {
    return;
  }
  // In air no pings are made that would show this.
  if (const std::optional<PosesUsed> here = poses.at(*sensed_at)) {
    NewestPing ping = newest.value_or(NewestPing{});
    if (!newest) {
      ping.range_m = usual_settings(config).range.max_range_m();
    }
    diagnosis.look(now, ping, *here, false, 0.0);
  }
  step(now, WaterChanged{out});
}

void Head::Impl::feed(TimePoint now) {
  if (playback != nullptr) {
    step(now, PingFed{playback->next_ping(index, now)});
  }
}

// In simulated time. True if a ping begins with the next step.
bool Head::Impl::next_ping_is_due(TimePoint now) {
  if (history.ping_clock() == PingClock::wall) {
    return false;
  }
  if (poses.begin_ping(now, next_ping, rendering.busy())) {
    return true;
  }
  if (next_ping && next_ping->from <= now && !history.newest()) {
    diagnosis.no_pose(now);
  }
  return false;
}

void Head::Impl::schedule(TimePoint now) {
  if (connected->transport().blocked()) {
    timer.cancel();  // the transport reports when it is writable again
    return;
  }
  std::optional<TimePoint> deadline = wake_at;
  // A ping that is already due waits for poses, and poses wake the head.
  if (history.ping_clock() != PingClock::wall && next_ping && next_ping->from > now) {
    deadline = deadline ? std::min(*deadline, next_ping->from) : next_ping->from;
  }
  timer.set(deadline, [weak = weak_from_this()] {
    if (const auto self = weak.lock()) {
      self->timer.passed();
      self->happen(TimePassed{});
    }
  });
}

// ---- Rendering

// Returns false if this ping is impossible.
bool Head::Impl::render(const PingJob& job) {
  if (job.record) {
    playback->started(index, job);
  }
  newest_job = {job.number, poses.of_ping(job)};
  const std::shared_ptr<const PosesUsed>& of_ping = newest_job.poses;
  if (!of_ping) {
    rendering.count_missing_pose();
    diagnosis.no_pose(poses.pose_time(job.transmit_time));
    return false;
  }
  if (recording.on()) {
    recording.posed(of_ping);
  }
  PosedPing ping = posed(job, of_ping);
  log.ping(job, type.turns(), ping.request.T_world_sonar);
  const render::Aperture& aperture = ping.request.settings.aperture;
  newest = NewestPing{job.settings,
                      job.range_m(),
                      job.bearing_rad,
                      of_ping->T_world_sonar,
                      aperture.beam_edges_rad.front() - aperture.beam_edges_rad.back(),
                      2 * aperture.elevation_limit_rad()};
  rendering.submit(
      std::move(ping), job.period,
      [weak = weak_from_this(), number = job.number, of_ping](RenderResult result) {
        const auto self = weak.lock();
        if (!self) {
          return;
        }
        if (self->rendering.take(result)) {
          self->done_or_lost([&] {
            self->diagnosis.look(self->clock.now(), *self->newest, *of_ping, result.statistics.sees_surface,
                                 result.statistics.echo_over_floor);
          });
          self->happen(PingRendered{image_of(number, std::move(result.samples),
                                             sensor_readings(of_ping->T_world_sonar, self->water_surface_z_m,
                                                             of_ping->sonar_velocity_mps))});
        } else {
          self->happen(PingNotRendered{number});
        }
      });
  return true;
}

PosedPing Head::Impl::posed(const PingJob& job, std::shared_ptr<const PosesUsed> poses_of_ping) const {
  const auto transducer = [&](const render::Pose& T_world_mount) {  // the motor is at rest during a ping
    return T_world_transducer(T_world_mount, job.bearing_rad);
  };
  const std::optional<render::Pose>& at_end = poses_of_ping->T_world_sonar_at_end;
  // In the recording, a replayed ping keeps its recorded number.
  PosedPing ping{.head = index,
                 .transmit_us = job.transmit_us,
                 .request = {transducer(poses_of_ping->T_world_sonar), type.sonar_settings(job, config),
                             job.record.value_or(job.number), config.seed,
                             at_end ? std::optional(transducer(*at_end)) : std::nullopt},
                 .poses = nullptr,
                 .hidden_body = poses.hidden_body()};
  ping.poses = std::move(poses_of_ping);
  return ping;
}

// ---- Log

void Head::Impl::report_every_period() {
  report_timer.expires_after(report_period);
  report_timer.async_wait([weak = weak_from_this()](const boost::system::error_code& error) {
    const auto self = weak.lock();
    if (self && !error && self->running) {
      self->log.rates(self->counts(), report_period);
      self->report_every_period();
    }
  });
}

}  // namespace sonard::server
