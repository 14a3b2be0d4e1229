// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/quick_table.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/bench/demo_ping.hpp"

namespace sonard::bench {

namespace {

constexpr double default_rms = 0.01;
constexpr double fast_rms = 0.05;

class Rows {
 public:
  Rows(const Measurements& measurements, std::string engine)
      : measurements_(measurements), engine_(std::move(engine)) {}

  void ping(const std::string& preset, const std::string& scene) {
    QuickRow row = timed(scene + ", " + preset, scene, find(scene, preset, "ping_ms"));
    row.bin_rms = find(scene, preset, "bin_rms");
    row.bin_rms_trim = find(scene, preset, "bin_rms_trim");
    row.first_echo_bins = find(scene, preset, "first_echo_bins");
    row.hole_fraction_60db = find(scene, preset, "hole_fraction_60db");
    row.promised_rms = preset == "fast" ? fast_rms : default_rms;
    rows.push_back(row);
  }

  void time(const std::string& what, const std::string& scene, std::optional<double> ms) {
    rows.push_back(timed(what, scene, ms));
  }

  void ratio(const std::string& what, std::optional<double> value) {
    rows.push_back({.what = what, .ratio = value});
  }

  void samples_ratio(const std::string& scene) {
    const auto error = find(scene, "default", "bin_rms");
    const auto samples = find(scene, "default", "samples");
    const auto needed = error && samples ? samples_needed(point_curve(scene), *error) : std::nullopt;
    ratio("samples at equal error, points / default, " + scene,
          needed ? std::optional(*needed / *samples) : std::nullopt);
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

  std::optional<double> ratio_of_pings(const std::string& scene, const std::string& to_scene) const {
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

  std::vector<QuickRow> rows;

 private:
  QuickRow timed(const std::string& what, const std::string& scene, std::optional<double> ms) const {
    QuickRow row{.what = what, .ms = ms};
    if (const auto point_ms = point_time_ms(measurements_, scene); ms && point_ms) {
      row.percent_of_points = 100 * *ms / *point_ms;
    }
    return row;
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

std::string number(std::optional<double> value, const char* unit = "") {
  if (!value) {
    return "";
  }
  const double size = std::abs(*value);
  return (size >= 100 ? fmt::format("{:.0f}", *value) : fmt::format("{:.3g}", *value)) + unit;
}

std::string percent(std::optional<double> share) {
  return share ? fmt::format("{:.2g} %", 100 * *share) : "";
}

std::string promise_of(const QuickRow& row) {
  if (!row.promised_rms || !row.bin_rms) {
    return "";
  }
  return fmt::format("{:g} %: {}", 100 * *row.promised_rms,
                     *row.bin_rms <= *row.promised_rms ? "kept" : "BROKEN");
}

}  // namespace

std::optional<double> point_time_ms(const Measurements& measurements, const std::string& scene) {
  const auto here = measurements.find({scene, "cpu", "point_8x1024"}, "ping_ms");
  return here ? here : measurements.find({"swell100k", "cpu", "point_8x1024"}, "ping_ms");
}

std::vector<QuickRow> quick_rows(const Measurements& measurements, const std::string& engine) {
  Rows table(measurements, engine);
  for (const char* const scene :
       {"flat100k", "swell100k", "ripple100k", "docking", "msis_swell", "msis_ripple"}) {
    for (const char* const preset : {"fast", "default"}) {
      table.ping(preset, scene);
    }
  }
  table.time("receiver, 256 x 1000", "plane", table.find("plane", "default", "receiver_ms"));
  table.time("receiver, 256 x 2411", "plane", table.find("plane", "default", "receiver_2411_ms"));
  if (engine == demo_ping.engine) {
    table.time("demo ping, all stages, as served", demo_ping.scene, measurements.find(demo_ping, "ping_ms"));
    for (const char* const stage : {"visibility", "binning", "multipath", "reception", "receiver"}) {
      table.time(fmt::format("  its {}", stage), demo_ping.scene,
                 measurements.find(demo_ping, fmt::format("{}_ms", stage)));
    }
  }
  table.ratio("swell1m / swell100k, default", table.ratio_of_pings("swell1m", "swell100k"));
  table.ratio("ping / visibility, default, worst", table.worst("ping_over_visibility"));
  for (const char* const scene : {"plane", "flat100k", "swell100k"}) {
    table.samples_ratio(scene);
  }
  table.ratio("unchanged / full ping, worst", table.worst("unchanged_over_ping"));
  table.ratio("points that differ when repeated", table.unrepeatable());
  return table.rows;
}

std::string format_quick(const std::vector<QuickRow>& rows) {
  constexpr const char* line = "{:<55} {:>8} {:>12} {:>8} {:>9} {:>10} {:>11} {:>12}  {}\n";
  const auto is_measured = [](const QuickRow& row) { return row.ms || row.ratio; };
  if (std::ranges::none_of(rows, is_measured)) {
    return "";
  }
  std::string text = fmt::format(line, "what", "ms", "% of points", "ratio", "bin RMS", "trimmed",
                                 "first echo", "holes -60 dB", "promise");
  for (const QuickRow& row : rows) {
    if (is_measured(row)) {
      text += fmt::format(line, row.what, number(row.ms), number(row.percent_of_points), number(row.ratio),
                          percent(row.bin_rms), percent(row.bin_rms_trim), number(row.first_echo_bins),
                          number(row.hole_fraction_60db), promise_of(row));
    }
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
