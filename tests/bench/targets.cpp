// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/targets.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string_view>

namespace sonard::bench {

namespace {

constexpr double first_echo_bound_bins = 0.5;
constexpr double faint_hole_bound = 1e-3;
constexpr double default_rms = 0.01;
constexpr double fast_rms = 0.05;
// Time of point_8x1024 on the machine with two slow cores whose milliseconds define the targets.
constexpr double slow_point_ms = 75;

double percent_of_points(double ms, double point_ms) {
  return 100 * ms / point_ms;
}

class Rows {
 public:
  Rows(const Measurements& measurements, std::string engine)
      : measurements_(measurements), engine_(std::move(engine)) {}

  /// A ping of `scene` must have an error within `rms` and a time within `must_ms` of the slow machine.
  void ping(const std::string& preset, const std::string& scene, double must_ms, double aim_ms, double rms) {
    time(fmt::format("{} {}", preset, scene), scene, find(scene, preset, "ping_ms"), must_ms, aim_ms);
    rows.back().rms_bound = rms;
    rows.back().quality = quality(scene, preset);
  }

  void time(const std::string& what, const std::string& scene, std::optional<double> ms, double must_ms,
            double aim_ms) {
    TargetRow row;
    row.what = what + ", % of points";
    row.must = percent_of_points(must_ms, slow_point_ms);
    row.aim = percent_of_points(aim_ms, slow_point_ms);
    row.ms = ms;
    if (const auto point_ms = point_time_ms(measurements_, scene); ms && point_ms) {
      row.measured = percent_of_points(*ms, *point_ms);
    }
    rows.push_back(row);
  }

  void plain(const std::string& what, std::optional<double> measured, double must,
             std::optional<double> aim) {
    rows.push_back({what, must, aim, false, measured, std::nullopt, std::nullopt});
  }

  void samples_ratio(const std::string& scene, double must, double aim) {
    std::optional<double> ratio;
    const auto error = find(scene, "default", "bin_rms");
    const auto samples = find(scene, "default", "samples");
    if (error && samples) {
      const auto needed = samples_needed(point_curve(scene), *error);
      ratio = needed ? std::optional(*needed / *samples) : std::nullopt;
    }
    rows.push_back({"samples at equal error, points / default, " + scene, must, aim, true, ratio,
                    std::nullopt, std::nullopt});
  }

  std::optional<double> find(const std::string& scene, const std::string& preset,
                             const std::string& metric) const {
    return measurements_.find({scene, engine_, preset}, metric);
  }

  /// The largest of a metric over the scenes with objects, at the default preset.
  std::optional<double> worst(const std::string& metric) const {
    std::optional<double> result;
    for (const char* scene : {"flat100k", "swell100k", "ripple100k"}) {
      const auto value = find(scene, "default", metric);
      result = value && (!result || *value > *result) ? value : result;
    }
    return result;
  }

  std::optional<double> ratio(const std::string& scene, const std::string& to_scene) const {
    const auto a = find(scene, "default", "ping_ms"), b = find(to_scene, "default", "ping_ms");
    return a && b ? std::optional(*a / *b) : std::nullopt;
  }

  /// Number of points that gave different bits in a repetition.
  std::optional<double> unrepeatable() const {
    std::optional<double> count;
    for (const Measurement& m : measurements_.all()) {
      if (m.metric == "repeatable" && m.subject.engine == engine_) {
        count = count.value_or(0) + (m.value == 1 ? 0 : 1);
      }
    }
    return count;
  }

  std::vector<TargetRow> rows;

 private:
  std::optional<Quality> quality(const std::string& scene, const std::string& preset) const {
    const auto rms = find(scene, preset, "bin_rms");
    if (!rms) {
      return std::nullopt;
    }
    const auto also = [&](const char* metric) { return find(scene, preset, metric).value_or(NAN); };
    return Quality{*rms, also("bin_rms_trim"), also("first_echo_bins"), also("hole_fraction"),
                   also("hole_fraction_60db")};
  }

  /// From any engine that measured it, because both give the same points.
  std::vector<SamplesAndError> point_curve(const std::string& scene) const {
    std::vector<SamplesAndError> curve;
    for (const Measurement& m : measurements_.all()) {
      const bool of_points = m.subject.scene == scene && m.subject.preset.rfind("point_", 0) == 0;
      if (of_points && m.metric == "bin_rms") {
        if (const auto samples = measurements_.find(m.subject, "samples")) {
          curve.push_back({*samples, m.value});
        }
      }
    }
    return curve;
  }

  const Measurements& measurements_;
  std::string engine_;
};

std::string_view words(Verdict verdict) {
  switch (verdict) {
    case Verdict::not_measured:
      return "not measured";
    case Verdict::missed:
      return "MISSED";
    case Verdict::error_unknown:
      return "time met, no reference";
    case Verdict::error_too_high:
      return "MISSED: error";
    case Verdict::must_met:
      return "must met";
    case Verdict::aim_met:
      return "aim met";
  }
  return "";
}

std::string number(std::optional<double> value) {
  if (!value) {
    return "-";
  }
  const double size = std::abs(*value);
  return size >= 100 ? fmt::format("{:.0f}", *value) : fmt::format("{:.3g}", *value);
}

std::string describe(const Quality& quality) {
  return fmt::format("{:5.2f} % ({:.2f} %)  {:10.2f}  {:.1e} / {:.1e}", 100 * quality.bin_rms,
                     100 * quality.bin_rms_trim, quality.first_echo_bins, quality.hole_fraction,
                     quality.hole_fraction_60db);
}

}  // namespace

Verdict TargetRow::verdict() const {
  if (!measured) {
    return Verdict::not_measured;
  }
  const auto reaches = [&](double bound) { return at_least ? *measured >= bound : *measured <= bound; };
  if (!reaches(must)) {
    return Verdict::missed;
  }
  if (rms_bound && !quality) {
    return Verdict::error_unknown;
  }
  if (rms_bound && !keeps(*quality, *rms_bound)) {
    return Verdict::error_too_high;
  }
  return aim && reaches(*aim) ? Verdict::aim_met : Verdict::must_met;
}

bool keeps(const Quality& quality, double rms_bound) {
  return quality.bin_rms <= rms_bound && quality.first_echo_bins <= first_echo_bound_bins &&
         quality.hole_fraction == 0 && quality.hole_fraction_60db <= faint_hole_bound;
}

std::optional<double> point_time_ms(const Measurements& measurements, const std::string& scene) {
  const auto here = measurements.find({scene, "cpu", "point_8x1024"}, "ping_ms");
  return here ? here : measurements.find({"swell100k", "cpu", "point_8x1024"}, "ping_ms");
}

std::vector<TargetRow> target_rows(const Measurements& measurements, const std::string& engine) {
  Rows table(measurements, engine);
  table.ping("default", "flat100k", 4, 1.5, default_rms);
  table.ping("default", "swell100k", 15, 8, default_rms);
  table.ping("default", "ripple100k", 30, 15, default_rms);
  table.ping("fast", "flat100k", 2, 1, fast_rms);
  table.ping("fast", "swell100k", 6, 4.5, fast_rms);
  table.ping("fast", "ripple100k", 14, 9, fast_rms);
  table.ping("default", "docking", 90, 60, default_rms);
  table.ping("fast", "docking", 35, 20, fast_rms);
  table.ping("default", "msis_swell", 0.25, 0.1, default_rms);
  table.ping("default", "msis_ripple", 0.35, 0.2, default_rms);
  table.time("receiver 256x1000", "plane", table.find("plane", "default", "receiver_ms"), 0.5, 0.3);
  table.time("receiver 256x2411", "plane", table.find("plane", "default", "receiver_2411_ms"), 1.2, 0.8);
  table.plain("swell1m / swell100k, default", table.ratio("swell1m", "swell100k"), 2, 1.4);
  table.plain("ping / visibility, default, worst", table.worst("ping_over_visibility"), 1.4, 1.2);
  table.samples_ratio("plane", 200, 1000);
  table.samples_ratio("flat100k", 50, 250);
  table.samples_ratio("swell100k", 20, 60);
  table.plain("unchanged / full ping, worst", table.worst("unchanged_over_ping"), 1.0 / 20, std::nullopt);
  table.plain("points that differ when repeated", table.unrepeatable(), 0, std::nullopt);
  return table.rows;
}

std::string format_targets(const std::vector<TargetRow>& rows) {
  constexpr const char* line = "{:<53} {:>7} {:>8} {:>8} {:>6}  {:<23} {:<46}\n";
  std::string text = fmt::format(line, "what", "ms", "measured", "must", "aim", "verdict",
                                 "bin RMS (trimmed)  first echo  holes / -60 dB");
  for (const TargetRow& row : rows) {
    const std::string must = fmt::format("{} {}", row.at_least ? ">=" : "<=", number(row.must));
    text += fmt::format(line, row.what, number(row.ms), number(row.measured), must, number(row.aim),
                        words(row.verdict()), row.quality ? describe(*row.quality) : "");
  }
  return text;
}

std::optional<double> samples_needed(std::vector<SamplesAndError> curve, double error) {
  if (curve.size() < 2 || !(error > 0)) {
    return std::nullopt;
  }
  std::sort(curve.begin(), curve.end(),
            [](const SamplesAndError& a, const SamplesAndError& b) { return a.samples < b.samples; });
  std::size_t next = 1;
  while (next + 1 < curve.size() && curve[next].error > error) {
    ++next;
  }
  const SamplesAndError &a = curve[next - 1], &b = curve[next];
  const double order = std::log(a.error / b.error) / std::log(b.samples / a.samples);
  if (!(order > 0)) {
    return std::nullopt;
  }
  return a.samples * std::pow(a.error / error, 1 / order);
}

}  // namespace sonard::bench
