#include "server/devices/micron_head.hpp"

#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "protocol/micron/device.hpp"
#include "server/devices/deadline_timer.hpp"
#include "server/devices/micron_head_log.hpp"
#include "server/devices/micron_settings.hpp"
#include "server/devices/playback.hpp"
#include "server/devices/serial/serial_link.hpp"
#include "server/recording/head_recording.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::seconds report_period{10};

}  // namespace

struct MicronHead::Impl : std::enable_shared_from_this<MicronHead::Impl> {
  Impl(const MicronHeadConfig& head_config, int stream_number, const HeadServices& head_services)
      : config(head_config),
        services(head_services),
        stream(stream_number),
        power_up(services.clock.now()),
        device(config.device, power_up),
        link(services.io, config.serial, services.clock),
        rendering(config, stream, services),
        timer(services.io),
        report_timer(services.io),
        log(config.name, config.device),
        recording(services.recorder, stream, services.clock) {}

  const MicronHeadConfig config;
  const HeadServices services;
  const int stream;
  const TimePoint power_up;

  micron::Device device;
  SerialLink link;
  HeadRendering rendering;
  DeadlineTimer timer;
  asio::steady_timer report_timer;
  MicronHeadLog log;
  HeadRecording recording;
  micron::MicronJob job_to_record;                   // the one that is out
  std::shared_ptr<const PosesUsed> poses_to_record;  // of the same
  bool running = false;

  void start();
  void stop();
  MicronHeadCounters total() const;

  void on_bytes(std::span<const std::uint8_t> bytes);
  void on_rendered(std::uint64_t ping_number, RenderResult result);
  void pump();
  void advance_device(TimePoint now);
  void advance_and_render(TimePoint now);
  void offer_recorded(TimePoint now);
  void step_device(TimePoint now);
  void record_sent();
  bool permit_ping(TimePoint now);
  void drop_unheard_job(TimePoint now);
  bool render(const micron::MicronJob& job);
  void schedule(TimePoint now);
  void report_every_period();
};

MicronHead::MicronHead(const MicronHeadConfig& config, int stream, const HeadServices& services)
    : impl_(std::make_shared<Impl>(config, stream, services)) {}

MicronHead::~MicronHead() {
  impl_->stop();
}

void MicronHead::start() {
  impl_->start();
}
void MicronHead::stop() {
  impl_->stop();
}
void MicronHead::poses_changed() {
  if (impl_->config.device.waits_for_permission) {
    impl_->pump();
  }
}
std::optional<std::chrono::nanoseconds> MicronHead::spare_poses() const {
  return impl_->rendering.spare_poses();
}
MicronHeadCounters MicronHead::counters() const {
  return impl_->total();
}
SerialAddresses MicronHead::addresses() const {
  return impl_->link.addresses();
}

// Handlers hold the head weakly: one that is still queued when the head is gone does nothing.
void MicronHead::Impl::start() {
  running = true;
  decltype(SerialPortEvents::passed) passed;
  decltype(SerialPortEvents::ended) ended;
  if (recording.on()) {  // a copy: it holds no reference to the head
    passed = [to = recording](const WireEnds& ends, bool to_client, std::span<const std::uint8_t> bytes) {
      to.piece(ends, to_client, bytes);
    };
    ended = [to = recording](const WireEnds& ends) { to.client_left(ends); };
  }
  link.start(
      [weak = weak_from_this()](std::span<const std::uint8_t> bytes, const std::string&) {
        if (const auto self = weak.lock()) {
          self->on_bytes(bytes);
        }
      },
      [weak = weak_from_this()](const std::string&) {
        if (const auto self = weak.lock()) {
          self->device.on_host_gone();
          self->rendering.rest();
        }
      },
      std::move(passed), std::move(ended));
  for (const std::string& port : link.descriptions()) {
    spdlog::info("head={} serves {}", config.name, port);
  }
  report_every_period();
  pump();
}

void MicronHead::Impl::stop() {
  if (!std::exchange(running, false)) {
    return;
  }
  timer.cancel();
  report_timer.cancel();
  link.stop();
  log.totals(total());
}

MicronHeadCounters MicronHead::Impl::total() const {
  MicronHeadCounters all;
  static_cast<RenderCounters&>(all) = rendering.counters();
  all.device = device.counters();
  all.link = link.counters();
  return all;
}

void MicronHead::Impl::on_bytes(std::span<const std::uint8_t> bytes) {
  device.on_bytes(services.clock.now(), bytes);
  pump();
}

void MicronHead::Impl::on_rendered(std::uint64_t ping_number, RenderResult result) {
  const TimePoint now = services.clock.now();
  if (rendering.take(result)) {
    device.on_line(now, {ping_number, std::move(result.samples.u8)});
  } else {
    device.on_line_failed(now, ping_number);
  }
  pump();
}

// Does all that is due now and sleeps until the next thing is. Called after every event.
void MicronHead::Impl::pump() {
  if (!running) {
    return;
  }
  const TimePoint now = services.clock.now();
  advance_device(now);
  for (std::vector<std::uint8_t>& frame : device.take_outgoing()) {
    link.send(std::move(frame));
  }
  log.state(now, device.state(now));
  schedule(now);
}

void MicronHead::Impl::advance_device(TimePoint now) {
  drop_unheard_job(now);  // new parameters have called it off, and the next ping waits for its answer
  do {
    advance_and_render(now);
  } while (permit_ping(now));
}

void MicronHead::Impl::advance_and_render(TimePoint now) {
  step_device(now);
  while (const std::optional<micron::MicronJob> job = device.take_job()) {
    if (render(*job)) {
      return;
    }
    // The device must hear of it, and has a next deadline only after it has advanced over it. Each turn takes
    // one of the lines that are owed, so this ends.
    device.on_line_failed(now, job->ping_number);
    step_device(now);
  }
}

void MicronHead::Impl::step_device(TimePoint now) {
  offer_recorded(now);
  device.advance(now);
  record_sent();
}

void MicronHead::Impl::offer_recorded(TimePoint now) {
  if (config.device.plays_back && services.playback != nullptr) {
    services.playback->progress(stream, now, device.counters());
    device.offer(services.playback->next_line(stream, now));
  }
}

// By the clock of the source. True when a ping begins with the next advance().
bool MicronHead::Impl::permit_ping(TimePoint now) {
  if (!config.device.waits_for_permission) {
    return false;
  }
  if (!rendering.begin_ping(now, device.ping_wish())) {
    return false;
  }
  device.permit_ping();
  return true;
}

void MicronHead::Impl::record_sent() {
  std::optional<micron::SentLine> line = device.take_sent_line();
  if (line && recording.on() && poses_to_record && line->ping_number == job_to_record.ping_number) {
    recording.micron_line({std::move(*line), job_to_record, poses_to_record});
  }
}

void MicronHead::Impl::drop_unheard_job(TimePoint now) {
  const std::optional<std::uint64_t> ping_number = device.called_off();
  if (ping_number && rendering.withdraw()) {
    device.on_line_failed(now, *ping_number);
  }
}

// False when this ping cannot be made.
bool MicronHead::Impl::render(const micron::MicronJob& job) {
  log.settings(job, *device.parameters());
  if (job.record) {
    services.playback->started(stream, job, *device.parameters());
  }
  const TimePoint pose_time = rendering.pose_time(job.transmit_time);
  const std::optional<render::Pose> T_world_mount = rendering.T_world_mount(pose_time);
  if (!T_world_mount) {
    rendering.count_missing_pose();
    return false;
  }
  if (recording.on()) {
    job_to_record = job;
    poses_to_record = rendering.poses_used(job.transmit_time);
    recording.posed(poses_to_record);
  }
  const auto since_power_up =
      std::chrono::duration_cast<std::chrono::microseconds>(job.transmit_time - power_up);
  std::optional<render::Pose> T_world_at_end = rendering.T_world_mount(pose_time + job.listening_time());
  if (T_world_at_end) {  // the motor rests meanwhile
    T_world_at_end = T_world_transducer(*T_world_at_end, job);
  }
  // A recorded line goes to the recording under the number that it has there.
  HeadPing ping{job.record.value_or(job.ping_number),
                pose_time,
                static_cast<std::uint64_t>(since_power_up.count()),
                T_world_transducer(*T_world_mount, job),
                T_world_at_end,
                to_sonar_settings(job, config)};
  log.ping(job, ping);
  rendering.submit(std::move(ping), [weak = weak_from_this(), number = job.ping_number](RenderResult result) {
    if (const auto self = weak.lock()) {
      self->on_rendered(number, std::move(result));
    }
  });
  return true;
}

void MicronHead::Impl::schedule(TimePoint now) {
  std::optional<TimePoint> deadline = device.next_deadline();
  // A wish that is due already waits for poses, which wake the head themselves.
  if (const auto wish = device.ping_wish(); config.device.waits_for_permission && wish && wish->from > now) {
    deadline = deadline ? std::min(*deadline, wish->from) : wish->from;
  }
  timer.set(deadline, [weak = weak_from_this()] {
    if (const auto self = weak.lock()) {
      self->timer.passed();
      self->pump();
    }
  });
}

void MicronHead::Impl::report_every_period() {
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
