#include "server/devices/gemini_head.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "protocol/gemini/device.hpp"
#include "protocol/gemini/ping_plan.hpp"
#include "server/config/addresses.hpp"
#include "server/devices/deadline_timer.hpp"
#include "server/devices/faulty_link.hpp"
#include "server/devices/gemini_head_log.hpp"
#include "server/devices/gemini_settings.hpp"
#include "server/devices/head_rendering.hpp"
#include "server/devices/interfaces.hpp"
#include "server/devices/playback.hpp"
#include "server/devices/udp_endpoint.hpp"
#include "server/program_log/peer_log.hpp"
#include "server/recording/head_recording.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;

constexpr Ipv4 limited_broadcast = 0xFFFFFFFF;
constexpr std::chrono::seconds report_period{10};

void keep_earlier(std::optional<TimePoint>& earliest, const std::optional<TimePoint>& other) {
  if (other && (!earliest || *other < *earliest)) {
    earliest = other;
  }
}

/// What a log keeps of the job that is out: a ping comes onto the wire before the next job is taken.
struct PingToRecord {
  std::uint64_t number = 0;
  TimePoint transmit_time{};
  double gain_percent = 0.0;
  std::shared_ptr<const PosesUsed> poses;
};

}  // namespace

struct GeminiHead::Impl : std::enable_shared_from_this<GeminiHead::Impl> {
  Impl(const GeminiHeadConfig& head_config, int stream_number, const HeadServices& head_services);

  const GeminiHeadConfig config;
  const HeadServices services;
  const int stream;

  gemini::Device device;
  gemini::DeviceAddresses addresses;
  std::unique_ptr<UdpEndpoint> socket;
  std::unique_ptr<UdpEndpoint> trigger;
  HeadRendering rendering;
  FaultyLink to_surface;
  FaultyLink from_surface;
  DeadlineTimer timer;
  asio::steady_timer report_timer;
  std::uint64_t not_allowed = 0;
  GeminiHeadLog log;
  PeerLog address_log;  // a client may program addresses and reboot as often as it likes
  HeadRecording recording;
  std::optional<PingToRecord> ping_to_record;
  bool running = false;

  void start();
  void stop();
  void listen();
  Endpoint own_end() const;
  void listen_for_triggers();
  GeminiHeadCounters total() const;

  void on_datagram(const Datagram& datagram);
  void on_rendered(std::uint64_t ping_number, RenderResult result);
  void pump();
  void take_from_surface(TimePoint now);
  void advance_device(TimePoint now);
  void advance_and_render(TimePoint now);
  void offer_recorded(TimePoint now);
  bool permit_ping(TimePoint now);
  void drop_unheard_job(TimePoint now);
  void schedule(TimePoint now);

  void record_served();
  void send(TimePoint now, const std::vector<gemini::Outgoing>& outgoing);
  void address_status(const gemini::SharedBytes& bytes, std::vector<Datagram>& datagrams) const;
  Ipv4 source_address() const;
  void follow_addresses();
  void check_interface();

  bool render(const gemini::PingJob& job);
  bool out_of_water(TimePoint pose_time) const;

  void report_every_period();
};

GeminiHead::GeminiHead(const GeminiHeadConfig& config, int stream, const HeadServices& services)
    : impl_(std::make_shared<Impl>(config, stream, services)) {}

GeminiHead::~GeminiHead() {
  impl_->stop();
}

void GeminiHead::start() {
  impl_->start();
}
void GeminiHead::stop() {
  impl_->stop();
}
void GeminiHead::poses_changed() {
  if (impl_->config.device.waits_for_permission) {
    impl_->pump();
  }
}
std::optional<std::chrono::nanoseconds> GeminiHead::spare_poses() const {
  return impl_->rendering.spare_poses();
}
GeminiHeadCounters GeminiHead::counters() const {
  return impl_->total();
}

GeminiHead::Impl::Impl(const GeminiHeadConfig& head_config, int stream_number,
                       const HeadServices& head_services)
    : config(head_config),
      services(head_services),
      stream(stream_number),
      device(config.device, services.clock.now()),
      addresses(device.addresses()),
      socket(std::make_unique<UdpEndpoint>(services.io, Endpoint{config.bind_address, config.command_port})),
      rendering(config, stream_number, services),
      to_surface(config.link.to_surface, config.link.seed),
      from_surface(config.link.from_surface, ~config.link.seed),  // the two directions draw apart
      timer(services.io),
      report_timer(services.io),
      log(config.name),
      recording(services.recorder, stream_number, services.clock) {
  if (config.trigger) {
    trigger = std::make_unique<UdpEndpoint>(services.io, *config.trigger);
  }
  check_interface();
}

// ---- Life
// ----------------------------------------------------------------------------------------------------

void GeminiHead::Impl::start() {
  running = true;
  listen();
  if (trigger) {
    listen_for_triggers();
  }
  report_every_period();
  pump();
}

void GeminiHead::Impl::stop() {
  if (!std::exchange(running, false)) {
    return;
  }
  timer.cancel();
  report_timer.cancel();
  socket->close();
  if (trigger) {
    trigger->close();
  }
  log.totals(total());
}

// Handlers hold the head weakly: one that is still queued when the head is gone does nothing.
void GeminiHead::Impl::listen() {
  UdpEndpoint::Sent sent;
  if (recording.on()) {
    sent = [weak = weak_from_this()](std::span<const Datagram> datagrams) {
      if (const auto self = weak.lock()) {
        self->recording.datagrams(datagrams, /*to_client=*/true, self->own_end());
      }
    };
  }
  socket->start(
      [weak = weak_from_this()](const Datagram& datagram) {
        if (const auto self = weak.lock()) {
          self->on_datagram(datagram);
        }
      },
      [weak = weak_from_this()] {
        if (const auto self = weak.lock()) {
          self->pump();
        }
      },
      std::move(sent));
}

// Where datagrams come from, as far as that is known.
Endpoint GeminiHead::Impl::own_end() const {
  const Endpoint local = socket->local_endpoint();
  return {local.address != 0 ? local.address : addresses.alternate, local.port};
}

void GeminiHead::Impl::listen_for_triggers() {
  trigger->start([weak = weak_from_this()](const Datagram& edge) {
    const auto self = weak.lock();
    if (self && allows(self->config.allow, edge.remote.address)) {
      self->device.on_trigger(self->services.clock.now());
      self->pump();
    }
  });
}

GeminiHeadCounters GeminiHead::Impl::total() const {
  GeminiHeadCounters all;
  static_cast<RenderCounters&>(all) = rendering.counters();
  all.not_allowed = not_allowed;
  all.device = device.counters();
  all.socket = socket->counters();
  all.to_surface = to_surface.counters();
  all.from_surface = from_surface.counters();
  return all;
}

// ---- Events
// --------------------------------------------------------------------------------------------------

void GeminiHead::Impl::on_datagram(const Datagram& datagram) {
  if (!allows(config.allow, datagram.remote.address)) {
    ++not_allowed;
    log.stranger(datagram.remote.address);
    return;
  }
  if (recording.on()) {
    recording.datagrams({&datagram, 1}, /*to_client=*/false, own_end());
  }
  from_surface.push(services.clock.now(), datagram);
  pump();
}

void GeminiHead::Impl::on_rendered(std::uint64_t ping_number, RenderResult result) {
  const TimePoint now = services.clock.now();
  if (rendering.take(result)) {
    device.on_image(now, {ping_number, std::move(result.samples.u8), std::move(result.samples.u16)});
  } else {
    device.on_image_failed(now, ping_number);
  }
  pump();
}

// Does all that is due now and sleeps until the next thing is. Called after every event.
void GeminiHead::Impl::pump() {
  if (!running) {
    return;
  }
  const TimePoint now = services.clock.now();
  take_from_surface(now);
  log.surface(device.surface());
  // A full socket holds the device back instead of letting datagrams pile up; `drained` calls again.
  if (!socket->blocked()) {
    advance_device(now);
  }
  socket->send(to_surface.take_due(now));
  log.surface(device.surface());
  follow_addresses();
  schedule(now);
}

void GeminiHead::Impl::take_from_surface(TimePoint now) {
  for (const Datagram& datagram : from_surface.take_due(now)) {
    const std::span<const std::uint8_t> bytes(datagram.bytes.data(), datagram.bytes.size());
    device.on_datagram(now, datagram.remote.address, datagram.local, bytes);
  }
}

void GeminiHead::Impl::advance_device(TimePoint now) {
  drop_unheard_job(now);  // a command has called it off, and the next ping waits for its answer
  device.set_out_of_water(out_of_water(services.poses.present(now)));
  offer_recorded(now);
  do {
    advance_and_render(now);
  } while (permit_ping(now));
  drop_unheard_job(now);  // the surface has just timed out
}

void GeminiHead::Impl::advance_and_render(TimePoint now) {
  device.advance(now);
  record_served();
  send(now, device.take_outgoing());
  while (const std::optional<gemini::PingJob> job = device.take_job()) {
    if (render(*job)) {
      break;
    }
    // The device must hear of it, and has a next deadline only after it has advanced over it. Rendering
    // ahead, it may ask for the next ping at once; each turn moves on by a ping period, so this ends.
    device.on_image_failed(now, job->ping_number);
    device.advance(now);
    record_served();
    send(now, device.take_outgoing());
  }
}

// By the clock of the source. True when a ping begins with the next advance().
bool GeminiHead::Impl::permit_ping(TimePoint now) {
  if (!config.device.waits_for_permission) {
    return false;
  }
  if (device.surface() == 0) {
    rendering.rest();
  }
  if (!rendering.begin_ping(now, device.ping_wish())) {
    return false;
  }
  device.permit_ping();
  return true;
}

void GeminiHead::Impl::offer_recorded(TimePoint now) {
  if (config.device.plays_back && services.playback != nullptr) {
    services.playback->progress(stream, now, device.counters());
    device.offer(services.playback->next_ping(stream, now));
  }
}

// A ping that is called off while other heads are being rendered is not rendered.
void GeminiHead::Impl::drop_unheard_job(TimePoint now) {
  const std::optional<std::uint64_t> ping_number = device.called_off();
  if (ping_number && rendering.withdraw()) {
    device.on_image_failed(now, *ping_number);
  }
}

void GeminiHead::Impl::schedule(TimePoint now) {
  std::optional<TimePoint> deadline = from_surface.next_due();
  keep_earlier(deadline, to_surface.next_due());
  if (!socket->blocked()) {
    keep_earlier(deadline, device.next_deadline());
    // A wish that is due already waits for poses, which wake the head themselves.
    if (const auto wish = device.ping_wish();
        config.device.waits_for_permission && wish && wish->from > now) {
      keep_earlier(deadline, wish->from);
    }
  }
  timer.set(deadline, [weak = weak_from_this()] {
    if (const auto self = weak.lock()) {
      self->timer.passed();
      self->pump();
    }
  });
}

// ---- Sending
// -------------------------------------------------------------------------------------------------

void GeminiHead::Impl::record_served() {
  std::optional<gemini::ServedPing> served = device.take_served();
  if (served && ping_to_record && ping_to_record->number == served->ping_number) {
    recording.gemini_ping({std::move(*served), ping_to_record->transmit_time, ping_to_record->gain_percent,
                           std::move(ping_to_record->poses)});
    ping_to_record.reset();
  }
}

void GeminiHead::Impl::send(TimePoint now, const std::vector<gemini::Outgoing>& outgoing) {
  std::vector<Datagram> datagrams;
  datagrams.reserve(outgoing.size());
  for (const gemini::Outgoing& item : outgoing) {
    if (item.to == gemini::Outgoing::To::status) {
      recording.gemini_status(item.bytes);
      address_status(item.bytes, datagrams);
    } else {
      datagrams.push_back({{item.surface, config.surface_port}, item.reply_from, item.bytes});
    }
  }
  if (config.link.to_surface.transparent()) {
    socket->send(std::move(datagrams));  // the hot path: a batch stays a batch
    return;
  }
  for (Datagram& datagram : datagrams) {
    to_surface.push(now, std::move(datagram));
  }
}

void GeminiHead::Impl::address_status(const gemini::SharedBytes& bytes,
                                      std::vector<Datagram>& datagrams) const {
  const Ipv4 source = source_address();
  const auto add = [&](Ipv4 host) { datagrams.push_back({{host, config.surface_port}, source, bytes}); };
  switch (config.status.mode) {
    case StatusDestination::Mode::limited_broadcast:
      add(limited_broadcast);
      break;
    case StatusDestination::Mode::directed_broadcast:
      add(addresses.alternate | ~addresses.netmask);
      break;
    case StatusDestination::Mode::unicast:
      std::for_each(config.status.hosts.begin(), config.status.hosts.end(), add);
      break;
  }
}

// Where status packets come from. On a socket bound to one address the kernel knows; on one bound to all it
// must be told, or a limited broadcast would leave by the interface of the default route.
Ipv4 GeminiHead::Impl::source_address() const {
  if (socket->local_endpoint().address != 0 || !owner_of(addresses.alternate, interface_addresses())) {
    return 0;
  }
  return addresses.alternate;
}

// A reboot may have applied an address that the client has programmed (docs/protocols/gemini.md 3.9).
void GeminiHead::Impl::follow_addresses() {
  const gemini::DeviceAddresses current = device.addresses();
  if (current == addresses) {
    return;
  }
  const gemini::DeviceAddresses before = std::exchange(addresses, current);
  address_log.info("head={} answers on {} mask {} from now on", config.name, address_text(current.alternate),
                   address_text(current.netmask));
  check_interface();
  if (current.alternate == before.alternate || socket->local_endpoint().address != before.alternate) {
    return;
  }
  try {
    socket = std::make_unique<UdpEndpoint>(services.io, Endpoint{current.alternate, config.command_port});
    listen();
  } catch (const SocketError& error) {
    address_log.error("head={} stays on {}: {}", config.name, address_text(before.alternate), error.what());
  }
}

void GeminiHead::Impl::check_interface() {
  const std::optional<InterfaceAddress> owner = owner_of(addresses.alternate, interface_addresses());
  if (!owner) {
    address_log.warn(
        "head={} reports the address {}, which this machine does not have: clients will send there",
        config.name, address_text(addresses.alternate));
  } else if (owner->netmask != addresses.netmask) {
    address_log.warn(
        "head={} reports the netmask {}, but {} has {}: later clients stay silent when masks differ",
        config.name, address_text(addresses.netmask), owner->interface, address_text(owner->netmask));
  }
}

// ---- Rendering
// -----------------------------------------------------------------------------------------------

// False when this ping cannot be made.
bool GeminiHead::Impl::render(const gemini::PingJob& job) {
  log.settings(job);
  if (job.record) {
    services.playback->started(stream, job);
  }
  const TimePoint pose_time = rendering.pose_time(job.transmit_time);
  const std::optional<render::Pose> T_world_sonar = rendering.T_world_mount(pose_time);
  if (!T_world_sonar) {
    rendering.count_missing_pose();
    return false;
  }
  if (recording.on()) {
    ping_to_record = {job.ping_number, job.transmit_time,
                      job.recorded_gain_percent.value_or(job.gain_percent),
                      rendering.poses_used(job.transmit_time)};
    recording.posed(ping_to_record->poses);
  }
  const std::uint64_t transmit_us = device.clock_us(job.transmit_time);
  log.ping(job, transmit_us, *T_world_sonar);
  // A recorded ping goes to the recording under the number that it has there.
  rendering.submit({job.record.value_or(job.ping_number), pose_time, transmit_us, *T_world_sonar,
                    rendering.T_world_mount(pose_time + gemini::acoustic_time(job.native_lines)),
                    to_sonar_settings(job, config)},
                   [weak = weak_from_this(), number = job.ping_number](RenderResult result) {
                     if (const auto self = weak.lock()) {
                       self->on_rendered(number, std::move(result));
                     }
                   });
  return true;
}

bool GeminiHead::Impl::out_of_water(TimePoint pose_time) const {
  if (!services.water_surface_z_m) {
    return false;
  }
  const std::optional<render::Pose> T_world_sonar = rendering.T_world_mount(pose_time);
  return T_world_sonar && T_world_sonar->position_m.z > *services.water_surface_z_m;
}

// ---- Log
// -----------------------------------------------------------------------------------------------------

void GeminiHead::Impl::report_every_period() {
  report_timer.expires_after(report_period);
  report_timer.async_wait([weak = weak_from_this()](const boost::system::error_code& error) {
    const auto self = weak.lock();
    if (self && !error && self->running) {
      self->log.rates(self->total(), report_period);
      self->report_every_period();
    }
  });
}

}  // namespace sonard::server
