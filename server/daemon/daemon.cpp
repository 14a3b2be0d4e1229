// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/daemon.hpp"

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/scene/reader_jail.hpp"
#include "server/clock/clock.hpp"
#include "server/config/overlaps.hpp"
#include "server/daemon/exhaustion.hpp"
#include "server/daemon/exit_codes.hpp"
#include "server/daemon/process.hpp"
#include "server/daemon/resolve_mounts.hpp"
#include "server/devices/device_type.hpp"
#include "server/devices/head.hpp"
#include "server/devices/head_status.hpp"
#include "server/devices/ping_dump.hpp"
#include "server/devices/playback.hpp"
#include "server/diagnosis/pose_stream.hpp"
#include "server/error/error.hpp"
#include "server/net/interfaces.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/pose/pose_history.hpp"
#include "server/pose/pose_inputs.hpp"
#include "server/pose/pose_intake.hpp"
#include "server/program_log/peer_log.hpp"
#include "server/recording/recorder.hpp"
#include "server/rendering/engine_choice_file.hpp"
#include "server/rendering/world_renderer.hpp"
#include "server/web/web_server.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;

std::string head_key(std::size_t index, const std::string& rest) {
  return fmt::format("heads[{}].{}", index, rest);
}

constexpr unsigned threads_of_opengl = 6;  // Mesa's, in addition to one per core

// By head; null for a head that dumps nothing.
std::vector<std::unique_ptr<PingDump>> make_dumps(const std::vector<HeadConfig>& heads) {
  std::vector<std::unique_ptr<PingDump>> dumps(heads.size());
  for (std::size_t i = 0; i < heads.size(); ++i) {
    const HeadConfig& head = heads[i];
    if (head.dump_directory) {
      try {
        dumps[i] = std::make_unique<PingDump>(*head.dump_directory, head.name);
      } catch (const std::exception& error) {
        throw Error(ErrorKind::configuration, error.what(), head_key(i, "dump.directory"));
      }
    }
  }
  return dumps;
}

// Null if nothing is recorded.
std::unique_ptr<Recorder> make_recorder(const DaemonConfig& config) {
  return config.recording ? std::make_unique<Recorder>(*config.recording, recorded_heads(config.heads))
                          : nullptr;
}

// Null if no page is served.
std::unique_ptr<WebServer> make_page(const DaemonConfig& config) {
  if (!config.web) {
    return nullptr;
  }
  try {
    return std::make_unique<WebServer>(*config.web);
  } catch (const SocketError& error) {
    throw Error(error.kind, error.what(), "web.bind");
  }
}

// Runs everything that serves. Threads: main constructs it, waits in run() and ends it. The I/O thread runs
// `io_` with pose inputs, history and heads. Each RenderService has a render thread. Scanning heads have
// their own RenderService: a line takes less than a millisecond and must not wait for a fan that takes a
// hundred.
//
// Shutdown, in the order of run(): a signal or end() wakes main, which stops the page. It posts stop_io(),
// which closes every socket and cancels every timer. It joins the render threads, which finish their current
// pings. It drops the work guard, so that `io_` runs out of work, and joins the I/O thread. It stops the
// recorder. Only then are the members destroyed, on main, in reverse order.
class Daemon {
 public:
  Daemon(const DaemonConfig& config, const render::World& world, const RendererFactory& make_renderer,
         Playback* playback, ReloadCheck may_begin_anew);

  /// Serves until a signal or end(). Returns the exit code.
  int run();
  /// False if the recorder's thread still waits for the disk.
  bool all_written() const { return all_written_; }

 private:
  RenderServiceHooks hooks();
  std::unique_ptr<RenderService> make_renderer_of(bool scanning, const DaemonConfig& config,
                                                  const RendererFactory& make_renderer);
  RenderService& renderer_of(const HeadConfig& head) const {
    return *(type_of(head).scanning() ? beam_renderer_ : fan_renderer_);
  }
  void say_what_the_gpu_may_miss(const std::vector<HeadConfig>& heads) const;
  std::string engine_text() const;
  void warm_up(const std::vector<HeadConfig>& heads) const;
  void poses_changed();
  void look_at_streams();
  void look_at_addresses();
  std::optional<std::chrono::nanoseconds> pose_lead() const;
  void start_page(const DaemonConfig& config, const render::World& world);
  DaemonStatus status() const;
  void wait_for_signal();
  void reload();
  void checked(const std::optional<std::string>& problem);
  void end_when_played();
  void run_io();
  void stop_io();
  void end(int exit_code);

  SteadyClock clock_;
  asio::io_context lifetime_;                          // of main: signals and end()
  asio::posix::stream_descriptor signals_{lifetime_};  // see catch_signals()
  std::uint8_t signal_ = 0;                            // the last signal read
  int exit_code_ = exit_clean;                         // of main
  asio::io_context io_;
  Playback* playback_;  // may be null
  ReloadCheck may_begin_anew_;
  asio::steady_timer playback_timer_;
  PoseHistory poses_;
  PoseIntake intake_;
  std::unique_ptr<PoseInputs> inputs_;
  std::vector<std::unique_ptr<PingDump>> dumps_;
  std::unique_ptr<Recorder> recorder_;                           // null if nothing is recorded
  std::unique_ptr<WebServer> page_;                              // null if no page is served
  std::unique_ptr<RenderService> fan_renderer_, beam_renderer_;  // null if no head needs it
  std::vector<std::unique_ptr<Head>> heads_;
  asio::steady_timer stream_timer_{io_}, address_timer_{io_};
  std::vector<PlannedSocket> other_sockets_;  // of poses and page
  OwnAddresses other_addresses_;              // of other_sockets_
  PeerLog address_log_;
  bool io_stopped_ = false;     // of the I/O thread: timers are not set again
  std::set<std::string> told_;  // codes of pose findings already logged, by input
  std::filesystem::path recorded_into_;
  std::string ready_line_;
  bool checking_ = false, check_again_ = false;  // of main
  bool all_written_ = true;
  std::jthread check_;  // last member: it uses lifetime_
};

Daemon::Daemon(const DaemonConfig& config, const render::World& world, const RendererFactory& make_renderer,
               Playback* playback, ReloadCheck may_begin_anew)
    : playback_(playback),
      may_begin_anew_(std::move(may_begin_anew)),
      playback_timer_(io_),
      poses_(config.poses),
      intake_(io_, poses_, {[this] { poses_changed(); }, [this] { return pose_lead(); }}),
      inputs_(std::make_unique<PoseInputs>(
          io_, config.poses, clock_,
          [this](const pose::PoseSample& sample, TimePoint arrival) { intake_.take(sample, arrival); },
          [this] { return intake_.hold(); })),
      dumps_(make_dumps(config.heads)),
      recorder_(make_recorder(config)),
      page_(make_page(config)),
      fan_renderer_(make_renderer_of(false, config, make_renderer)),
      beam_renderer_(make_renderer_of(true, config, make_renderer)) {
  for (std::size_t i = 0; i < config.heads.size(); ++i) {
    RenderService& renderer = renderer_of(config.heads[i]);
    const HeadServices services{io_,
                                clock_,
                                renderer,
                                poses_,
                                world.water_surface_z_m,
                                config.skip,
                                playback_,
                                recorder_.get(),
                                config.world.vehicle_model,
                                page_.get(),
                                &world};
    try {
      heads_.push_back(std::make_unique<Head>(config.heads[i], static_cast<int>(i), services));
    } catch (const SocketError& error) {
      const SocketTrouble trouble = trouble_of(error, type_of(config.heads[i]));
      throw Error(trouble.of_network ? ErrorKind::network : ErrorKind::configuration, error.what(),
                  head_key(i, trouble.key));
    }
  }
  for (PlannedSocket& socket : planned_sockets(config)) {
    if (!socket.key.starts_with("heads[")) {
      other_sockets_.push_back(std::move(socket));
    }
  }
  inputs_->start();
  warm_up(config.heads);
  say_what_the_gpu_may_miss(config.heads);
  start_page(config, world);
  ready_line_ = fmt::format("sonard ready heads={} world={} triangles={} engine=\"{}\"", heads_.size(),
                            world.name, world.triangle_count(), engine_text());
}

void Daemon::say_what_the_gpu_may_miss(const std::vector<HeadConfig>& heads) const {
  if (!engine_text().starts_with("gpu")) {
    return;
  }
  for (const HeadConfig& head : heads) {
    const std::string lost = render::missed_by_grid(usual_settings(head));
    if (!lost.empty()) {
      spdlog::warn("head={}: {}", head.name, lost);
    }
  }
}

// Engines of the renderers in use: one renderer may lose the GPU, the other keep it.
std::string Daemon::engine_text() const {
  const std::string fans = fan_renderer_ ? fan_renderer_->renderer_description() : "";
  const std::string beams = beam_renderer_ ? beam_renderer_->renderer_description() : fans;
  return fans.empty() || fans == beams ? beams : fmt::format("{}; scanning heads: {}", fans, beams);
}

std::unique_ptr<RenderService> Daemon::make_renderer_of(bool scanning, const DaemonConfig& config,
                                                        const RendererFactory& make_renderer) {
  const auto head_count =
      std::count_if(config.heads.begin(), config.heads.end(),
                    [scanning](const HeadConfig& head) { return type_of(head).scanning() == scanning; });
  return head_count > 0
             ? std::make_unique<RenderService>(make_renderer, static_cast<int>(head_count), hooks())
             : nullptr;
}

// Renders from the vehicle's pose, or from the origin if no pose is known yet.
void Daemon::warm_up(const std::vector<HeadConfig>& heads) const {
  const std::optional<PoseEstimate> vehicle = poses_.at(clock_.now());
  const render::Pose T_world_vehicle = vehicle ? vehicle->T_world_vehicle : render::Pose{};
  for (RenderService* renderer : {fan_renderer_.get(), beam_renderer_.get()}) {
    std::vector<render::HeadRequest> first_pings;
    for (std::size_t i = 0; i < heads.size(); ++i) {
      const HeadConfig& head = heads[i];
      if (&renderer_of(head) == renderer) {
        first_pings.push_back({static_cast<int>(i), usual_ping(head, T_world_vehicle)});
      }
    }
    if (!first_pings.empty()) {
      renderer->warm_up(std::move(first_pings));
    }
  }
}

void Daemon::start_page(const DaemonConfig& config, const render::World& world) {
  if (!page_) {
    return;
  }
  recorded_into_ = config.recording ? config.recording->directory : "";
  page_->start({.ask_status =
                    [this](std::function<void(DaemonStatus)> take) {
                      asio::post(io_, [this, take = std::move(take)] {
                        page_->on_page([take, now = status()]() mutable { take(std::move(now)); });
                      });
                    },
                .turn_recording =
                    recorder_ ? std::function<void(bool)>([this](bool on) { recorder_->turn(on); }) : nullptr,
                .identity = {config.file.string(), world.name, world.water_surface_z_m},
                .world = world});
  spdlog::info("web: {}", page_->address());
}

// Called on the I/O thread.
DaemonStatus Daemon::status() const {
  DaemonStatus status;
  status.at = clock_.now();
  status.engine = engine_text();
  for (const std::unique_ptr<Head>& head : heads_) {
    status.heads.push_back(head->status());
  }
  for (std::size_t i = 0; i < inputs_->size(); ++i) {
    const PoseSource& source = inputs_->source(i);
    status.inputs.push_back({source.description(), source.publisher(),
                             inputs_->statistics(i).in_all(status.at), source.counters(),
                             look_at_stream(*inputs_, i, status.at)});
  }
  status.ping_clock = inputs_->ping_clock();
  const TimePoint present = poses_.present(status.at);
  if (const std::optional<PoseEstimate> vehicle = poses_.at(present)) {
    status.T_world_vehicle = vehicle->T_world_vehicle;
  }
  status.stale_pose = poses_.stale_at(present);
  status.bodies = poses_.bodies_at(present);
  if (recorder_) {
    status.recording = {recorded_into_.string(), recorder_->on(), recorder_->counters()};
  }
  return status;
}

RenderServiceHooks Daemon::hooks() {
  RenderServiceHooks hooks;
  hooks.post = [this](std::function<void()> task) { asio::post(io_, std::move(task)); };
  hooks.on_failure = [this](const std::string& what) {
    spdlog::critical("engine: the renderer failed: {}", what);
    end(exit_renderer);
  };
  hooks.observe = [this](const PosedPing& ping, const render::PingSamples& samples) {
    if (PingDump* dump = dumps_[static_cast<std::size_t>(ping.head)].get()) {
      dump->write(ping, samples);
    }
  };
  return hooks;
}

void Daemon::poses_changed() {
  for (const std::unique_ptr<Head>& head : heads_) {
    head->poses_changed();
  }
}

// Runs every two seconds and logs new findings. An expired timer may call it once more after stop_io() has
// cancelled it.
void Daemon::look_at_streams() {
  if (io_stopped_) {
    return;
  }
  std::set<std::string> told;
  for (std::size_t i = 0; i < inputs_->size(); ++i) {
    for (const Finding& finding : look_at_stream(*inputs_, i, clock_.now())) {
      const std::string what = fmt::format("{} {}", i, finding.code);
      told.insert(what);
      if (!told_.contains(what) && finding.code != unreadable_code) {
        spdlog::warn("{}: {}", inputs_->source(i).description(), finding.text);
      }
    }
  }
  told_ = std::move(told);
  stream_timer_.expires_after(std::chrono::seconds{2});
  stream_timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      look_at_streams();
    }
  });
}

// Runs every second: a DHCP lease may change an address, or a cable may be unplugged.
void Daemon::look_at_addresses() {
  if (io_stopped_) {
    return;
  }
  const std::vector<InterfaceAddress> now = interface_addresses();
  for (const std::unique_ptr<Head>& head : heads_) {
    head->look_at_addresses(now);
  }
  std::vector<Ipv4> others;
  for (const PlannedSocket& socket : other_sockets_) {
    others.push_back(socket.endpoint.address);
  }
  const OwnAddresses::News news = other_addresses_.look(others, now);
  for (const PlannedSocket& socket : other_sockets_) {
    if (std::ranges::count(news.gone, socket.endpoint.address) > 0) {
      address_log_.warn(
          "{}: the address {} is gone from this machine: clients cannot reach it until it is back (plug the "
          "cable in, or renew the lease)",
          socket.key, address_text(socket.endpoint.address));
    }
  }
  address_timer_.expires_after(std::chrono::seconds{1});
  address_timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      look_at_addresses();
    }
  });
}

std::optional<std::chrono::nanoseconds> Daemon::pose_lead() const {
  std::optional<std::chrono::nanoseconds> most;
  for (const std::unique_ptr<Head>& head : heads_) {
    const auto lead = head->pose_lead();
    most = most ? std::max(most, lead) : lead;
  }
  return most;
}

int Daemon::run() {
  signals_.assign(catch_signals(std::chrono::seconds{1}));
  wait_for_signal();
  auto io_work = asio::make_work_guard(io_);
  std::thread io_thread(&Daemon::run_io, this);
  asio::post(io_, [this] {
    for (const std::unique_ptr<Head>& head : heads_) {
      head->start();
    }
    spdlog::info(ready_line_);
    tell_service_manager("READY=1");
    look_at_streams();
    look_at_addresses();
    end_when_played();
  });

  lifetime_.run();
  check_ = {};  // ends a running check
  tell_service_manager(exit_code_ == begins_anew ? "RELOADING=1" : "STOPPING=1");

  if (page_) {
    page_->stop();
  }
  asio::post(io_, [this] { stop_io(); });
  for (RenderService* renderer : {fan_renderer_.get(), beam_renderer_.get()}) {
    if (renderer != nullptr) {
      renderer->stop();
    }
  }
  io_work.reset();
  io_thread.join();
  if (recorder_) {
    all_written_ = recorder_->stop();
  }
  return exit_code_;
}

void Daemon::wait_for_signal() {
  signals_.async_read_some(asio::buffer(&signal_, 1),
                           [this](const boost::system::error_code& error, std::size_t) {
                             if (error) {
                               return;
                             }
                             if (signal_ == SIGHUP) {
                               reload();
                               wait_for_signal();
                               return;
                             }
                             spdlog::info("signal {}: stopping", signal_);
                             lifetime_.stop();
                           });
}

void Daemon::reload() {
  if (!may_begin_anew_) {
    spdlog::info("SIGHUP ignored: a replay cannot reload its configuration");
    return;
  }
  check_again_ = checking_;
  if (checking_) {
    return;
  }
  checking_ = true;
  spdlog::info("SIGHUP: reading the configuration again");
  check_ = std::jthread([this](const std::stop_token& stop) {
    asio::post(lifetime_, [this, problem = may_begin_anew_(stop)] { checked(problem); });
  });
}

void Daemon::checked(const std::optional<std::string>& problem) {
  checking_ = false;
  if (check_again_) {  // the file may have changed since it was read
    reload();
  } else if (problem) {
    spdlog::error("configuration invalid, keeping the current one: {}", *problem);
  } else {
    spdlog::info("configuration valid, restarting");
    exit_code_ = begins_anew;
    lifetime_.stop();
  }
}

// Polls, so a replay may end up to 0.1 s late. Its timer too may call it once more after stop_io().
void Daemon::end_when_played() {
  if (playback_ == nullptr || io_stopped_) {
    return;
  }
  if (playback_->finished(clock_.now())) {
    spdlog::info("replay: the recording has ended");
    end(exit_clean);
    return;
  }
  playback_timer_.expires_after(std::chrono::milliseconds{100});
  playback_timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      end_when_played();
    }
  });
}

void Daemon::run_io() {
  try {
    io_.run();
  } catch (const std::exception& error) {
    // Handlers do not throw on bytes from outside, so this is a defect or an exhausted resource.
    const std::optional<std::string> sentence = exhausted(error);
    spdlog::critical("the I/O thread failed: {}", sentence.value_or(error.what()));
    end(sentence ? exit_exhausted : exit_internal);
  }
}

void Daemon::stop_io() {
  io_stopped_ = true;
  playback_timer_.cancel();
  stream_timer_.cancel();
  address_timer_.cancel();
  inputs_->stop();
  intake_.stop();
  for (const std::unique_ptr<Head>& head : heads_) {
    head->stop();
  }
}

// Can be called from any thread.
void Daemon::end(int exit_code) {
  asio::post(lifetime_, [this, exit_code] {
    exit_code_ = exit_code;
    lifetime_.stop();
  });
}

}  // namespace

render::World read_world(const WorldConfig& config) {
  if (config.file.empty()) {
    render::World open_water;
    open_water.name = "open_water";
    open_water.origin = config.origin;
    return open_water;
  }
  render::World world = render::load_world(
      config.file, render::model_folders_from_environment(),
      config.skips_missing_files ? render::MissingFiles::skip : render::MissingFiles::error, config.origin,
      static_cast<std::size_t>(config.max_triangles));
  if (world.triangle_count() == 0 && !config.open_water) {
    throw render::WorldError(
        {fmt::format("{}: the world has no triangles (expected a surface that reflects sound; for open "
                     "water, write `world: empty`, or add `empty: true` beside `file`)",
                     config.file.string())},
        world.warnings);
  }
  return world;
}

render::World load_world_of(DaemonConfig& config) {
  try {
    render::World world = read_world(config.world);
    if (const std::string missing = render::missing_from_reader_jail();
        !missing.empty() && !config.world.file.empty()) {
      spdlog::warn("world {}: {}", world.name, missing);
    }
    for (const std::string& warning : world.warnings) {
      spdlog::warn("{}", warning);
    }
    if (world.triangle_count() == 0) {
      spdlog::info("world {}: no surface reflects sound; images contain only noise and water clutter",
                   world.name);
    }
    if (world.origin) {
      spdlog::info("world {}: (0, 0, 0) is at latitude {:.7f}, longitude {:.7f}, altitude {:.2f} m",
                   world.name, world.origin->latitude_deg, world.origin->longitude_deg,
                   world.origin->altitude_m);
    }
    for (const std::string& line : world.maps) {
      spdlog::info("world {}: map {}", world.name, line);
    }
    for (const std::string& line : world.left_out) {
      spdlog::info("world {}: left out: {}", world.name, line);
    }
    for (const ConfigProblem& problem : resolve_mounts(config, world)) {
      throw Error(ErrorKind::configuration, problem.message, problem.key);
    }
    return world;
  } catch (const render::WorldError& error) {
    for (const std::string& line : error.warnings) {
      spdlog::warn("{}", line);
    }
    throw Error(ErrorKind::configuration, error.what(), "world.file", error.more);
  }
}

render::RendererOptions renderer_options(const DaemonConfig& config) {
  render::RendererOptions options;
  options.engine = config.engine;
  options.skip = config.skip;
  options.ray_curvature_per_m = config.water.sound_speed_gradient_per_s / config.water.sound_speed_mps;
  options.gpu = config.gpu;
  options.report = [](const std::string& line) { spdlog::warn("{}", line); };
  return options;
}

int run_daemon(DaemonConfig config, const ReloadCheck& may_begin_anew) {
  const render::World world = load_world_of(config);
  for (const HeadConfig& head : config.heads) {
    try {
      check_sampling_of(head);
    } catch (const render::RequestError& error) {
      throw Error(ErrorKind::configuration, fmt::format("head '{}': {}", head.name, error.what()),
                  "sampling");
    }
  }
  const render::RendererOptions options = renderer_options(config);
  if (options.engine == render::EngineKind::gpu) {
    make_sure_of_threads(std::thread::hardware_concurrency() + threads_of_opengl);
  }
  for (const render::SkipRuleEntry& entry : render::skip_rules) {
    if (!config.skip.on(entry.rule)) {
      spdlog::info("engine: skip rule {} is off", entry.name);
    }
  }
  return serve(config, world, world_renderer_factory(world, options, engine_choice_path()), nullptr,
               may_begin_anew);
}

int serve(const DaemonConfig& config, const render::World& world, const RendererFactory& make_renderer,
          Playback* playback, const ReloadCheck& may_begin_anew) {
  auto daemon = std::make_unique<Daemon>(config, world, make_renderer, playback, may_begin_anew);
  const int code = daemon->run();
  const bool all_written = daemon->all_written();
  daemon.reset();
  if (!all_written && code != begins_anew) {
    std::_Exit(code);  // a thread still waits for the disk and uses objects that exit() destroys
  }
  return code;
}

}  // namespace sonard::server
