#include "server/offline/scan_frames.hpp"

#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "protocol/micron/line_job.hpp"
#include "protocol/micron/line_timing.hpp"
#include "protocol/micron/sweep.hpp"
#include "protocol/micron/units.hpp"
#include "server/devices/micron_settings.hpp"
#include "server/npy/npy_file.hpp"
#include "server/offline/json_text.hpp"
#include "server/offline/sidecar.hpp"
#include "server/offline/vehicle_body.hpp"

namespace sonard::server {
namespace {

double natural_period_ns(const micron::HeadCommand& command, const micron::DeviceConfig& device) {
  const auto period =
      device.line_period.value_or(micron::line_timing(command, device, command.step).period(device));
  return static_cast<double>(period.count());
}

picture::TurnShape shape_of(const micron::ScanSettings& settings) {
  picture::TurnShape shape;
  if (settings.sector) {
    shape.left = settings.sector->left;
    shape.width = micron::wrapped(settings.sector->right - settings.sector->left);
  }
  shape.step = settings.step;
  shape.bins = settings.bins;
  shape.bin_m = micron::bin_length_m(settings);
  return shape;
}

/// Where a scan begins: ahead, or at the limit that it turns away from.
int first_bearing(const micron::ScanSettings& settings) {
  if (!settings.sector) {
    return micron::bearing_ahead;
  }
  return settings.clockwise ? settings.sector->left : settings.sector->right;
}

}  // namespace

ScanFrames::ScanFrames(const MicronHeadConfig& head, int stream, const Voyage& voyage,
                       const OfflineOptions& options, BodyTruth* truth)
    : head_(head),
      stream_(stream),
      voyage_(voyage),
      asked_(options.micron),
      command_(micron::make_head_command(options.micron)),
      times_{voyage.start_ns(),
             options.rate_hz ? 1e9 / *options.rate_hz : natural_period_ns(command_, head.device)},
      truth_(truth),
      picture_(shape_of(asked_), {.radius_px = options.radius_px}) {
  lay_out_sweeps(times_.count_until(voyage.end_ns()));
}

// A turn ends before it comes back to where it began; a sweep ends with the line at the other limit.
void ScanFrames::lay_out_sweeps(int lines) {
  micron::Sweep sweep(head_.device.limits_order);
  sweep.configure(command_, first_bearing(asked_));
  int turned = 0;
  first_lines_.push_back(0);
  for (int line = 0; line < lines; ++line) {
    bearings_.push_back(sweep.bearing());
    const bool at_limit = line > 0 && sweep.code() != micron::SweepCode::normal;
    turned += sweep.step();
    if (asked_.sector ? at_limit : turned >= micron::units_per_turn) {
      first_lines_.push_back(line + 1);
      turned -= micron::units_per_turn;
    }
  }
}

std::string ScanFrames::name(int frame) const {
  return fmt::format("scan_{:06}", frame);
}

micron::MicronJob ScanFrames::job(int line) const {
  return micron::make_line_job(command_, head_.device, bearings_[static_cast<std::size_t>(line)]);
}

render::PingRequest ScanFrames::request(int line) const {
  const micron::MicronJob ping = job(line);
  const std::int64_t time_ns = times_.at(line);
  const auto pose_at = [&](std::int64_t time) {
    return T_world_transducer(voyage_.T_world_vehicle(time) * head_.T_vehicle_sonar, ping);
  };
  return {pose_at(time_ns), to_sonar_settings(ping, head_), static_cast<std::uint64_t>(line), head_.seed,
          pose_at(time_ns + ping.listening_time().count())};
}

void ScanFrames::pass(render::SonarRenderer& renderer, int frame) {
  for (int line = first_line(frame); line < first_line(frame + 1); ++line) {
    const render::PingRequest ping = request(line);
    place_vehicle(voyage_, times_.at(line), renderer, nullptr);
    if (!renderer.pass_ping(ping, stream_)) {
      renderer.render_ping(ping, stream_);
    }
  }
}

Frame ScanFrames::render(render::SonarRenderer& renderer, int frame) {
  const int first = first_line(frame);
  const int columns = first_line(frame + 1) - first;
  const auto bins = static_cast<std::size_t>(micron::effective_bins(command_));
  const auto at = [columns](std::size_t bin, int column) {
    return bin * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  };
  NpyTable samples{static_cast<int>(bins), columns, std::vector<std::uint8_t>(at(bins, 0)), {}};
  std::vector<std::uint16_t> bodies(truth_ != nullptr ? samples.u8.size() : 0);
  auto lines = std::make_shared<std::vector<picture::TurnLine>>();
  for (int column = 0; column < columns; ++column) {
    const render::PingRequest ping = request(first + column);
    place_vehicle(voyage_, times_.at(first + column), renderer, truth_);
    picture::TurnLine line{bearings_[static_cast<std::size_t>(first + column)],
                           renderer.render_ping(ping, stream_).u8};
    const std::vector<std::uint16_t> heard =
        truth_ != nullptr ? truth_->bodies_in(ping) : std::vector<std::uint16_t>{};
    for (std::size_t bin = 0; bin < bins; ++bin) {
      samples.u8[at(bin, column)] = line.samples[bin];
      if (truth_ != nullptr) {
        bodies[at(bin, column)] = heard[bin];
      }
    }
    lines->push_back(std::move(line));
  }
  Frame made;
  made.npy = npy_bytes(samples);
  if (truth_ != nullptr) {
    made.bodies_npy = npy_bytes(truth_->table(samples.rows, samples.columns, bodies));
  }
  made.sidecar = sidecar(frame);
  made.draw = [this, lines, frame] {
    return picture_.draw(*lines, fmt::format("{}   scan {}   {} lines   {:.1f} m", head_.name, frame,
                                             lines->size(), asked_.bins * micron::bin_length_m(asked_)));
  };
  return made;
}

std::string ScanFrames::settings_json() const {
  const std::string sector =
      asked_.sector
          ? json_list({micron::bearing_deg(asked_.sector->left), micron::bearing_deg(asked_.sector->right)})
          : "null";
  return fmt::format(
      "\"range_m\": {}, \"gain_percent\": {}, \"sound_speed_mps\": {}, \"bins\": {}, \"step_deg\": {}, "
      "\"sector_deg\": {}, \"period_s\": {}",
      asked_.range_m, asked_.gain_percent, asked_.sound_speed_mps, asked_.bins,
      asked_.step * micron::step_unit_deg, sector, times_.period_ns / 1e9);
}

std::string ScanFrames::sidecar(int frame) const {
  const int first = first_line(frame);
  const int end = first_line(frame + 1);
  const micron::MicronJob ping = job(first);
  std::vector<double> bearings_rad, stamps_s;
  std::vector<std::string> vehicle, transducer;
  for (int line = first; line < end; ++line) {
    bearings_rad.push_back(job(line).bearing_rad);
    stamps_s.push_back(static_cast<double>(times_.at(line)) / 1e9);
    vehicle.push_back(json_pose(voyage_.T_world_vehicle(times_.at(line))));
    transducer.push_back(json_pose(request(line).T_world_sonar));
  }
  SidecarText text;
  text.add_frame({frame, head_.name, "micron", times_.at(first), unix_ns(frame)});
  text.add("first_ping_number", std::to_string(first));
  text.add("stream", std::to_string(stream_));
  text.add("seed", std::to_string(head_.seed));
  text.add_samples(name(frame), false, {"bin", ping.bins}, {"line", end - first});
  text.add("geometry",
           fmt::format("{{\"line_step_m\": {}, \"range_m\": {}, \"sound_speed_mps\": {}, "
                       "\"bearings_rad\": {}}}",
                       ping.bin_length_m, ping.range_m(), ping.sound_speed_mps, json_list(bearings_rad)));
  text.add("settings", "{" + settings_json() + "}");
  text.add("stamps_s", json_list(stamps_s));
  text.add("T_world_vehicle", fmt::format("[{}]", fmt::join(vehicle, ", ")));
  text.add("T_world_sonar", fmt::format("[{}]", fmt::join(transducer, ", ")));
  text.add_truth(name(frame), truth_);
  return text.finish();
}

}  // namespace sonard::server
