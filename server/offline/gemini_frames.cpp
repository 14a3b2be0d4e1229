#include "server/offline/gemini_frames.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "protocol/gemini/bearings.hpp"
#include "server/devices/gemini_settings.hpp"
#include "server/npy/npy_file.hpp"
#include "server/offline/json_text.hpp"
#include "server/offline/sidecar.hpp"
#include "server/offline/vehicle_body.hpp"
#include "server/recording/gemini_glf.hpp"

namespace sonard::server {
namespace {

/// The shortest time from ping to ping: the head's own limit, the way of the last echo, and the datagrams on
/// the link (docs/protocols/gemini.md 8.4, 8.5).
std::chrono::nanoseconds natural_period(const gemini::PingPlan& plan, const gemini::DeviceConfig& device) {
  constexpr int head_and_tail = 2;
  return std::max({device.min_ping_period, plan.listening_time(),
                   (plan.job.lines() + head_and_tail) * device.line_period});
}

gemini::PingPlan plan_of(const gemini::PingSettings& settings, const GeminiHeadConfig& head) {
  // What make_ping_config() makes a head can do.
  return gemini::plan_ping(gemini::make_ping_config(settings), head.device).value();
}

/// The fan as a client sees it, which counts ranges in the speed of sound that it has set.
picture::FanShape shape_of(const gemini::PingPlan& plan, const gemini::PingSettings& settings) {
  const int native_lines = 1 << plan.job.compression_log2;
  return {gemini::bearings_rad(), plan.job.lines(),
          settings.sound_speed_mps / (2.0 * gemini::line_rate_hz) * native_lines};
}

}  // namespace

GeminiFrames::GeminiFrames(const GeminiHeadConfig& head, const HeadPlace& place, const Voyage& voyage,
                           const OfflineOptions& options, BodyTruth* truth)
    : head_(head),
      place_(place),
      voyage_(voyage),
      asked_(options.gemini),
      plan_(plan_of(options.gemini, head)),
      times_{voyage.start_ns(), options.rate_hz
                                    ? 1e9 / *options.rate_hz
                                    : static_cast<double>(natural_period(plan_, head.device).count())},
      count_(times_.count_until(voyage.end_ns())),
      truth_(truth),
      fan_(shape_of(plan_, asked_), {.radius_px = options.radius_px}) {}

std::string GeminiFrames::name(int frame) const {
  return fmt::format("ping_{:06}", frame);
}

render::Pose GeminiFrames::T_world_sonar(std::int64_t time_ns) const {
  return voyage_.T_world_vehicle(time_ns) * head_.T_vehicle_sonar;
}

render::PingRequest GeminiFrames::request(int frame) const {
  const std::int64_t time_ns = times_.at(frame);
  return {T_world_sonar(time_ns), to_sonar_settings(plan_.job, head_), static_cast<std::uint64_t>(frame),
          head_.seed, T_world_sonar(time_ns + plan_.listening_time().count())};
}

void GeminiFrames::pass(render::SonarRenderer& renderer, int frame) {
  const render::PingRequest ping = request(frame);
  place_vehicle(voyage_, times_.at(frame), renderer, nullptr);
  if (!renderer.pass_ping(ping, place_.stream)) {
    renderer.render_ping(ping, place_.stream);
  }
}

Frame GeminiFrames::render(render::SonarRenderer& renderer, int frame) {
  const render::PingRequest ping = request(frame);
  place_vehicle(voyage_, times_.at(frame), renderer, truth_);
  render::PingSamples rendered = renderer.render_ping(ping, place_.stream);
  auto samples = std::make_shared<const NpyTable>(
      NpyTable{rendered.lines, rendered.beams, std::move(rendered.u8), std::move(rendered.u16)});
  Frame made;
  made.npy = npy_bytes(*samples);
  if (truth_ != nullptr) {
    made.bodies_npy = npy_bytes(truth_->table(samples->rows, samples->columns, truth_->bodies_in(ping)));
  }
  made.sidecar = sidecar(frame, ping);
  made.draw = [this, samples, frame] { return fan_.draw(eight_bit_matrix(*samples), caption(frame)); };
  return made;
}

std::string GeminiFrames::caption(int frame) const {
  return fmt::format("{}   ping {}   {:.3f} s   {:.1f} m", head_.name, frame,
                     1e-9 * static_cast<double>(times_.at(frame)), fan_.geometry().range_m());
}

std::optional<glf::ImageRecord> GeminiFrames::record(int frame, std::string_view npy) const {
  std::optional<NpyTable> samples =
      parse_npy(npy, plan_.job.lines(), gemini::beam_count, plan_.job.sixteen_bit);
  if (!samples) {
    return std::nullopt;
  }
  GeminiPing ping;
  ping.head = plan_.head;
  ping.head.ping_id = static_cast<std::uint16_t>(frame & 0xFF);
  ping.head.transmit_time_us = static_cast<std::uint64_t>((times_.at(frame) - voyage_.start_ns()) / 1000);
  ping.pixels = plan_.job.sixteen_bit ? eight_bit_pixels(samples->u16) : std::move(samples->u8);
  ping.transmit_unix_ns = unix_ns(frame);
  ping.gain_percent = plan_.job.gain_percent;
  return to_glf_image(std::move(ping), {0, static_cast<std::uint8_t>(place_.gemini_number)});
}

std::string GeminiFrames::settings_json() const {
  return fmt::format(
      "\"range_m\": {}, \"gain_percent\": {}, \"sound_speed_mps\": {}, \"compression\": {}, \"bits\": {}, "
      "\"native_lines\": {}, \"period_s\": {}",
      asked_.range_m, asked_.gain_percent, asked_.sound_speed_mps, plan_.job.compression_log2,
      plan_.job.sixteen_bit ? 16 : 8, plan_.job.native_lines, 1e-9 * times_.period_ns);
}

std::string GeminiFrames::sidecar(int frame, const render::PingRequest& request) const {
  const render::RangeLines& range = request.settings.range;
  const double line_step_m = range.step_m * (1 << range.compression_log2);
  SidecarText text;
  text.add_frame({frame, head_.name, "gemini_720i", times_.at(frame), unix_ns(frame)});
  text.add("sonar_id", std::to_string(head_.device.sonar_id));
  text.add("ping_number", std::to_string(frame));
  text.add("stream", std::to_string(place_.stream));
  text.add("seed", std::to_string(head_.seed));
  text.add_samples(name(frame), plan_.job.sixteen_bit, {"line", plan_.job.lines()},
                   {"beam", gemini::beam_count});
  text.add("geometry", fmt::format("{{\"line_step_m\": {}, \"range_m\": {}, \"sound_speed_mps\": {}, "
                                   "\"bearings_rad\": {}}}",
                                   line_step_m, line_step_m * plan_.job.lines(), plan_.job.sound_speed_mps,
                                   json_list(gemini::bearings_rad())));
  text.add("settings", "{" + settings_json() + "}");
  text.add("T_world_vehicle", json_pose(voyage_.T_world_vehicle(times_.at(frame))));
  text.add("T_world_sonar", json_pose(request.T_world_sonar));
  text.add("T_world_sonar_at_end", json_pose(*request.T_world_sonar_at_end));
  text.add_truth(name(frame), truth_);
  return text.finish();
}

}  // namespace sonard::server
