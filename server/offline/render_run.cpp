// SPDX-License-Identifier: Apache-2.0
#include "server/offline/render_run.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <deque>
#include <fstream>
#include <functional>
#include <future>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "common/text/counted.hpp"
#include "common/text/printable.hpp"
#include "protocol/glf/deflate.hpp"
#include "protocol/glf/log_time.hpp"
#include "protocol/pose/trajectory.hpp"
#include "renderer/errors.hpp"
#include "renderer/picture/picture_file.hpp"
#include "renderer/pipeline/engine_trial.hpp"
#include "renderer/pipeline/self_test.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "renderer/usable_cores.hpp"
#include "server/clock/clock.hpp"
#include "server/daemon/daemon.hpp"
#include "server/daemon/exit_codes.hpp"
#include "server/devices/device_type.hpp"
#include "server/offline/direction_frames.hpp"
#include "server/offline/fan_frames.hpp"
#include "server/offline/frame_findings.hpp"
#include "server/offline/frame_source.hpp"
#include "server/offline/glf_file.hpp"
#include "server/offline/jumps.hpp"
#include "server/offline/mcap_file.hpp"
#include "server/offline/output_folder.hpp"
#include "server/offline/progress.hpp"
#include "server/offline/sidecar.hpp"
#include "server/offline/sweep_frames.hpp"
#include "server/offline/vehicle_trajectory.hpp"
#include "server/recording/glf_device.hpp"
#include "server/recording/log_names.hpp"

namespace sonard::server {
namespace {

constexpr int png_level = 1;
constexpr const char* app_name = "sonard " SONARD_VERSION;

std::size_t chosen_head(const LoadedConfig& loaded, const std::string& name) {
  const std::vector<HeadConfig>& heads = loaded.config.heads;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < heads.size(); ++i) {
    names.push_back(heads[i].name);
    if (name.empty() || names.back() == name) {
      return i;
    }
  }
  throw Error(ErrorKind::configuration,
              fmt::format("no head is named '{}' (expected {})", name, fmt::join(names, " or ")), "heads");
}

/// The configuration with the seeds of the command line, if given, instead of the head's own.
DaemonConfig seeded(const LoadedConfig& loaded, const OfflineOptions& options) {
  DaemonConfig config = loaded.config;
  HeadConfig& head = config.heads[chosen_head(loaded, options.head)];
  head.seed = options.seed.value_or(head.seed);
  if (options.element_seed) {
    head.acoustics.aperture.element_seed = options.element_seed;
  }
  return config;
}

HeadPlace place_of(const std::vector<HeadConfig>& heads, std::size_t head) {
  HeadPlace place{static_cast<int>(head), 0};
  for (std::size_t i = 0; i < head; ++i) {
    place.glf_number += glf_device(*heads[i].type) != nullptr ? 1 : 0;
  }
  return place;
}

/// @throws Error, pose::TrajectoryError
VehicleTrajectory trajectory_with_bodies(const OfflineOptions& options, const render::World& world,
                                         const std::string& vehicle_model) {
  VehicleTrajectory trajectory(pose::load_trajectory(options.trajectory, options.axes), vehicle_model);
  for (const OfflineOptions::BodyWay& way : options.bodies) {
    const bool known = std::any_of(world.bodies.begin(), world.bodies.end(),
                                   [&](const render::Body& body) { return body.name == way.body; });
    if (!known || way.body == trajectory.vehicle_model()) {
      std::vector<std::string> names;
      for (const render::Body& body : world.bodies) {
        if (body.name != trajectory.vehicle_model()) {
          names.push_back(body.name);
        }
      }
      throw Error(
          ErrorKind::configuration,
          fmt::format("--body: '{}' cannot be moved (expected one of {})", way.body, fmt::join(names, ", ")),
          "world.file");
    }
    trajectory.add({way.body, pose::load_trajectory(way.trajectory, options.axes)});
  }
  return trajectory;
}

/// Sets the pings in which the vehicle counts as at rest: all with --still, none with --no-still, else pings
/// in which no vehicle moves like the trajectory.
VehicleTrajectory with_rests(VehicleTrajectory trajectory, const OfflineOptions& options) {
  if (options.still) {
    if (*options.still) {
      trajectory.rest_in_all_pings();
    }
    return trajectory;
  }
  Jumps jumps = find_jumps(trajectory.points());
  const std::string file = options.trajectory.string();
  if (jumps.independent) {
    trajectory.rest_in_all_pings();
    spdlog::warn(
        "{}: no vehicle moves like this ({}), so each ping is rendered with the sonar at rest. Add --still "
        "to render one frame for each pose, or --no-still to render the motion",
        file, jumps.first);
  } else if (jumps.count > 0) {
    spdlog::warn(
        "{}: {} of {} steps are jumps that no vehicle makes ({}); pings in them are rendered with the sonar "
        "at rest. Add --no-still to render the motion",
        file, jumps.count, jumps.steps.size(), jumps.first);
    trajectory.rest_in(std::move(jumps.steps));
  }
  return trajectory;
}

/// Only warns: a user may choose higher rates than the head can keep.
void warn_of_rate(const FrameSource& frames, const std::string& head) {
  if (frames.period_s() < frames.natural_period_s() * (1.0 - 1e-9)) {
    spdlog::warn(
        "--rate {:g} exceeds the limit of head '{}': at most {:.4g} pings per second with these settings",
        1.0 / frames.period_s(), head, 1.0 / frames.natural_period_s());
  }
}

/// Stores a SIGINT or SIGTERM; a second one of the same kind has its default effect.
std::atomic<int> interrupted_by{0};
void watch_for_interruption() {
  struct sigaction action {};
  action.sa_handler = [](int signal) { interrupted_by = signal; };
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

std::unique_ptr<FrameSource> make_source(const std::vector<HeadConfig>& heads, std::size_t head,
                                         const VehicleTrajectory& trajectory, const OfflineOptions& options,
                                         BodyTruth* truth) {
  const DeviceType& type = type_of(heads[head]);
  std::unique_ptr<Survey> survey = type.survey(heads[head], options.survey);
  if (type.scanning()) {
    return std::make_unique<SweepFrames>(heads[head], static_cast<int>(head), std::move(survey), trajectory,
                                         options, truth);
  }
  if (survey->job(0).directions.any()) {
    return std::make_unique<DirectionFrames>(heads[head], place_of(heads, head), std::move(survey),
                                             trajectory, options, truth);
  }
  return std::make_unique<FanFrames>(heads[head], place_of(heads, head), std::move(survey), trajectory,
                                     options, truth);
}

Error not_of_this_frame(const std::filesystem::path& file) {
  return output_error(file, "does not contain the samples of this frame (delete it to render it again)");
}

std::uint32_t crc_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  glf::Crc32 crc;
  crc.add({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  return crc.value();
}

/// One run of the program over one trajectory.
class RenderRun {
 public:
  RenderRun(const LoadedConfig& loaded, const OfflineOptions& options);

  /// Stops between two frames if interrupted.
  void render_missing();
  /// Makes the logs if all frames of all processes exist.
  void finish();

 private:
  void choose_engine();
  std::string manifest() const;
  bool whole(int frame) const;
  bool has_clean_pictures(const std::string& name) const;
  bool wanted(int frame) const { return options_.shard.has(frame) && (options_.overwrite || !whole(frame)); }
  std::vector<int> wanted_frames() const;
  template <class Drawn>
  Drawn draw(const std::function<Drawn()>& draw_it);
  void write(int frame, const Frame& made);
  bool all_whole() const;
  std::string log_stamp() const { return glf::log_stamp(glf::glf_time_s(frames_->unix_ns(0), 0)); }
  void make_glf() const;
  void make_mcap() const;

  DaemonConfig config_;
  const OfflineOptions& options_;
  std::size_t head_;
  render::World world_;
  VehicleTrajectory trajectory_;
  render::SonarRenderer renderer_;
  std::unique_ptr<BodyTruth> truth_;
  std::unique_ptr<FrameSource> frames_;
  FrameFindings findings_;
  OutputFolder folder_;
  std::mutex drawing_;
};

// Runs the self-test first: a broken engine must not fill a folder. All frames come from one engine, because
// existing frames are not rendered again. If the GPU is lost, the run ends.
render::RendererOptions tested(render::RendererOptions options) {
  options.report = [](const std::string& line) {
    throw render::RendererError(line +
                                " (all frames of a run must come from one engine: run the command again to "
                                "continue, or render into another folder with engine: cpu)");
  };
  render::run_self_test(options);
  return options;
}

/// @throws Error, also if there are no frames
std::unique_ptr<FrameSource> make_frames(const std::vector<HeadConfig>& heads, std::size_t head,
                                         const VehicleTrajectory& trajectory, const OfflineOptions& options,
                                         BodyTruth* truth) {
  try {
    check_sampling_of(heads[head]);
  } catch (const render::RequestError& error) {
    throw Error(ErrorKind::configuration, error.what(), "sampling");
  }
  std::unique_ptr<FrameSource> frames = make_source(heads, head, trajectory, options, truth);
  if (frames->count() == 0) {
    throw Error(ErrorKind::configuration, fmt::format("{}: ends before the first sweep of head '{}' does",
                                                      options.trajectory.string(), heads[head].name));
  }
  return frames;
}

/// The world; if the head hides the vehicle, the vehicle's body has no parts.
/// @throws Error
render::World world_without_hidden(DaemonConfig& config, std::size_t head) {
  render::World world = load_world_of(config);
  for (render::Body& body : world.bodies) {
    if (config.heads[head].hides_vehicle && body.name == config.world.vehicle_model) {
      body.parts.clear();
    }
  }
  return world;
}

RenderRun::RenderRun(const LoadedConfig& loaded, const OfflineOptions& options)
    : config_(seeded(loaded, options)),
      options_(options),
      head_(chosen_head(loaded, options.head)),
      world_(world_without_hidden(config_, head_)),
      trajectory_(with_rests(
          trajectory_with_bodies(options, world_,
                                 config_.heads[head_].hides_vehicle ? "" : config_.world.vehicle_model),
          options)),
      renderer_(world_, tested(renderer_options(config_))),
      truth_(options.truth ? std::make_unique<BodyTruth>(world_, renderer_options(config_)) : nullptr),
      frames_(make_frames(config_.heads, head_, trajectory_, options, truth_.get())),
      findings_(world_, config_, head_, trajectory_),
      folder_(options.out) {
  warn_of_rate(*frames_, config_.heads[head_].name);
  if (usual_settings(config_.heads[head_]).directions.any() && options.clean_pictures) {
    throw Error(ErrorKind::configuration,
                fmt::format("--clean-png: head '{}' has directions, not range bins (omit the option)",
                            config_.heads[head_].name),
                "heads");
  }
  if (options.clean_pictures && options.truth && world_.bodies.size() > 255) {
    throw Error(
        ErrorKind::configuration,
        fmt::format("--clean-png: a mask has 8 bits, too few for the {} bodies of the world (expected at "
                    "most 255; omit --truth or --clean-png)",
                    world_.bodies.size()),
        "world.file");
  }
  const OutputFolder::Lock lock(folder_);
  choose_engine();
  folder_.claim(manifest(), options.overwrite);
}

// All frames of a folder come from one engine. With `auto`, it is the engine of the process that created the
// folder; other processes wait for it.
void RenderRun::choose_engine() {
  if (config_.engine != render::EngineKind::automatic) {
    return;
  }
  if (const std::optional<std::string> before = folder_.manifest()) {
    const Json json = Json::parse(*before, nullptr, false);
    renderer_.use_engine(json.is_object() && json.value("engine", "") == "gpu" ? render::EngineKind::gpu
                                                                               : render::EngineKind::cpu);
    if (manifest() == *before || !options_.overwrite) {
      return;
    }
  }
  const std::vector<render::HeadRequest> first{
      {static_cast<int>(head_),
       usual_ping(config_.heads[head_], trajectory_.T_world_vehicle(trajectory_.start_ns()))}};
  spdlog::info("engine auto: {}", describe(render::choose_engine_at_start(renderer_, first, config_.gpu)));
}

// Everything that determines the bytes of frames, except the program itself; nothing specific to this
// process.
std::string RenderRun::manifest() const {
  Json json{{"program", app_name},
            {"config_crc32", fmt::format("{:08x}", crc_of(config_.file))},
            {"world_crc32", fmt::format("{:08x}", crc_of(config_.world.file))},
            {"trajectory_crc32", fmt::format("{:08x}", crc_of(options_.trajectory))},
            {"axes", options_.axes == pose::Axes::ned_frd ? "ned_frd" : "enu_flu"},
            {"bearings", "positive to port"},  // formerly to starboard; must not mix in one folder
            {"engine", render::name_of(renderer_.engine())},
            {"head", config_.heads[head_].name},
            {"settings", frames_->settings_json()},
            {"frames", frames_->count()},
            {"radius_px", options_.radius_px},
            {"picture_every", options_.picture_every},
            {"truth", options_.truth}};
  if (options_.seed) {
    json["seed"] = *options_.seed;
  }
  if (options_.element_seed) {
    json["element_seed"] = *options_.element_seed;
  }
  if (options_.still) {
    json["still"] = *options_.still;
  }
  if (options_.clean_pictures) {
    json["clean_png"] = true;
  }
  for (const OfflineOptions::BodyWay& way : options_.bodies) {
    json["bodies_crc32"][way.body] = fmt::format("{:08x}", crc_of(way.trajectory));
  }
  return sidecar_text(json);
}

bool RenderRun::whole(int frame) const {
  const std::string name = frames_->name(frame);
  return folder_.has(sidecar_name(name)) && folder_.has(npy_name(name)) &&
         (!options_.draws(frame) || folder_.has(picture_name(name))) &&
         (!options_.truth || folder_.has(bodies_name(name))) &&
         (!options_.clean_pictures || has_clean_pictures(name));
}

bool RenderRun::has_clean_pictures(const std::string& name) const {
  const CleanNames names(name);
  return folder_.has(names.grey) && folder_.has(names.fan) &&
         (!options_.truth || (folder_.has(names.grey_mask) && folder_.has(names.fan_mask)));
}

std::vector<int> RenderRun::wanted_frames() const {
  std::vector<int> wanted_ones;
  for (int frame = 0; frame < frames_->count(); ++frame) {
    if (wanted(frame)) {
      wanted_ones.push_back(frame);
    }
  }
  return wanted_ones;
}

template <class Drawn>
Drawn RenderRun::draw(const std::function<Drawn()>& draw_it) {
  const std::lock_guard<std::mutex> lock(drawing_);
  return draw_it();
}

// The sidecar is written last: it marks the frame as complete.
void RenderRun::write(int frame, const Frame& made) {
  const std::string name = frames_->name(frame);
  folder_.write(npy_name(name), made.npy);
  if (!made.bodies_npy.empty()) {
    folder_.write(bodies_name(name), made.bodies_npy);
  }
  for (const auto& [file, contents] : made.more) {
    folder_.write(file, contents);
  }
  if (options_.draws(frame)) {
    folder_.write(picture_name(name), picture::png_file(draw(made.draw), png_level));
  }
  if (made.draw_clean) {
    for (const CleanPicture& picture : draw(made.draw_clean)) {
      folder_.write(picture.file, picture::png_file(picture.pixels, png_level));
    }
  }
  folder_.write(sidecar_name(name), made.sidecar);
}

// Threads draw, encode and write frames while the next ones are rendered: a picture takes half as long as a
// ping on two cores, and longer than a ping on eight.
void RenderRun::render_missing() {
  const std::vector<int> missing = wanted_frames();
  int of_shard = 0;
  for (int frame = 0; frame < frames_->count(); ++frame) {
    of_shard += options_.shard.has(frame) ? 1 : 0;
  }
  const int found = of_shard - static_cast<int>(missing.size());
  if (found > 0) {
    fmt::print(stderr, "{}: {}\n", printable(folder_.path().string()), found_text(of_shard, found));
  }
  Progress progress(of_shard, found);
  std::deque<std::future<void>> writing;
  const auto wait_until_fewer_than = [&](std::size_t count) {
    while (writing.size() >= count) {
      writing.front().get();
      writing.pop_front();
      progress.made(SteadyClock().now());
    }
  };
  // At least four, because they mostly wait for the disk, which can write several files at once.
  const std::size_t writers = std::max(4U, render::usable_cores() / 2);
  int next = 0;
  for (const int frame : missing) {
    if (interrupted_by != 0) {
      break;
    }
    for (; next < frame; ++next) {
      frames_->pass(renderer_, next);
    }
    Frame made = frames_->render(renderer_, frame);
    ++next;
    if (findings_.wants(frame)) {
      findings_.add(frames_->name(frame), made.view);
    }
    wait_until_fewer_than(writers);
    writing.push_back(
        std::async(std::launch::async, [this, frame, made = std::move(made)] { write(frame, made); }));
  }
  wait_until_fewer_than(1);
  progress.end();
  for (const std::string& line : findings_.lines()) {
    spdlog::warn("{}", line);
  }
  if (interrupted_by != 0 && progress.state().found + progress.state().made < of_shard) {
    fmt::print(stderr, "{}: {}\n", printable(folder_.path().string()), interrupted_text(progress.state()));
  }
}

// Returns at the first missing frame. Counting all missing frames would look at every file for each process,
// which over a network takes longer than rendering.
bool RenderRun::all_whole() const {
  for (int frame = 0; frame < frames_->count(); ++frame) {
    if (!whole(frame)) {
      return false;
    }
  }
  return true;
}

void RenderRun::finish() {
  const std::string out = printable(folder_.path().string());
  if (!all_whole()) {
    fmt::print("{}: this share is complete; other frames of all {} are missing\n", out, frames_->count());
    return;
  }
  const OutputFolder::Lock lock(folder_);
  if (frames_->makes_glf()) {
    make_glf();
  }
  if (options_.mcap) {
    make_mcap();
  }
  folder_.remove_parts();
  fmt::print("{}: {}\n", out, counted(frames_->count(), "frame"));
}

void RenderRun::make_glf() const {
  const std::string first = glf::log_name(log_stamp());
  if (folder_.has(first) && !options_.overwrite) {
    return;
  }
  GlfFile log(folder_, app_name);
  for (int frame = 0; frame < frames_->count(); ++frame) {
    const std::string file = npy_name(frames_->name(frame));
    const std::optional<glf::ImageRecord> record = frames_->record(frame, folder_.read(file));
    if (!record) {
      throw not_of_this_frame(folder_.path() / file);
    }
    log.add(*record);
  }
  log.close();
}

void RenderRun::make_mcap() const {
  const std::string name = mcap_path("", log_stamp()).string();
  if (folder_.has(name) && !options_.overwrite) {
    return;
  }
  McapFile log(folder_, config_.heads);
  for (int frame = 0; frame < frames_->count(); ++frame) {
    const std::string file = npy_name(frames_->name(frame));
    const std::vector<PingSent> pings = frames_->pings(frame, folder_.read(file));
    if (pings.empty()) {
      throw not_of_this_frame(folder_.path() / file);
    }
    for (const PingSent& ping : pings) {
      log.add(static_cast<int>(head_), ping);
    }
  }
  log.publish(name);
}

}  // namespace

int render_trajectory(const LoadedConfig& loaded, const OfflineOptions& options) {
  RenderRun run(loaded, options);
  watch_for_interruption();
  run.render_missing();
  if (interrupted_by != 0) {
    std::raise(interrupted_by);  // with the default handler, so that the parent process sees the signal
  }
  run.finish();
  return exit_clean;
}

}  // namespace sonard::server
