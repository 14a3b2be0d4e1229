// SPDX-License-Identifier: Apache-2.0
#include "protocol/pose/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

namespace sonard::pose {
namespace {

constexpr std::array<std::string_view, 8> columns{"t", "x", "y", "z", "qx", "qy", "qz", "qw"};
constexpr std::string_view csv_header = "t,x,y,z,qx,qy,qz,qw";
constexpr std::string_view blanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Removes and returns the front of `text` up to one of the characters in `end`, which is removed too.
std::string_view take_until(std::string_view& text, std::string_view end) {
  const std::size_t length = text.find_first_of(end);
  const std::string_view part = text.substr(0, length);
  text.remove_prefix(length == std::string_view::npos ? text.size() : length + 1);
  return part;
}

std::vector<std::string_view> csv_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  for (const auto commas = std::count(line.begin(), line.end(), ','); std::ssize(fields) <= commas;) {
    fields.push_back(trimmed(take_until(line, ",")));
  }
  return fields;
}

std::vector<std::string_view> tum_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  while (!line.empty()) {
    const std::string_view field = take_until(line, blanks);
    if (!field.empty()) {
      fields.push_back(field);
    }
  }
  return fields;
}

class Parser {
 public:
  Parser(const std::string& file, Axes axes) : file_(file), axes_(axes) {}

  Trajectory parse(std::string_view text) {
    if (text.substr(0, 3) == "\xEF\xBB\xBF") {  // byte order mark of Windows editors
      text.remove_prefix(3);
    }
    while (!text.empty()) {
      ++line_number_;
      const std::string_view line = trimmed(take_until(text, "\n"));
      if (!line.empty() && line.front() != '#') {
        take_line(line);
      }
    }
    if (points_.empty()) {
      fail("the trajectory has no points");
    }
    return Trajectory{std::move(points_)};
  }

 private:
  enum class Format { unknown, csv, tum };

  void take_line(std::string_view line) {
    if (format_ == Format::unknown && line.find(',') != std::string_view::npos) {
      format_ = Format::csv;
      take_header(line);
      return;
    }
    if (format_ == Format::unknown) {
      format_ = Format::tum;
    }
    take_point(format_ == Format::csv ? csv_fields(line) : tum_fields(line));
  }

  void take_header(std::string_view line) {
    const auto fields = csv_fields(line);
    if (!std::equal(fields.begin(), fields.end(), columns.begin(), columns.end())) {
      fail("expected the header " + std::string{csv_header});
    }
  }

  void take_point(const std::vector<std::string_view>& fields) {
    if (fields.size() != columns.size()) {
      fail("expected 8 columns (" + std::string{csv_header} + "), found " + std::to_string(fields.size()));
    }
    std::array<double, columns.size()> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      v[i] = number(fields[i], columns[i]);
    }
    Transform transform{{v[1], v[2], v[3]}, {v[7], v[4], v[5], v[6]}};
    const TransformFault fault = normalize(transform);
    if (fault != TransformFault::none) {
      fail(describe(fault));
    }
    if (axes_ == Axes::ned_frd) {
      transform = enu_flu_from_ned_frd(transform);
    }
    points_.push_back({time_after_last(v[0], fields[0]), transform});
  }

  double number(std::string_view field, std::string_view column) const {
    double value = 0.0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error == std::errc::result_out_of_range) {
      fail(std::string{column} + " '" + std::string{field} + "' is out of range");
    }
    if (error != std::errc{} || end != field.data() + field.size()) {
      fail(std::string{column} + " '" + std::string{field} + "' is not a number");
    }
    if (!std::isfinite(value)) {
      fail(std::string{column} + " is not finite");
    }
    return value;
  }

  std::int64_t time_after_last(double time_s, std::string_view field) {
    if (std::abs(time_s) > static_cast<double>(max_time_ns) * 1e-9) {
      fail("t '" + std::string{field} + "' is beyond 4e9 s; time is in seconds");
    }
    const std::int64_t time_ns = std::llround(time_s * 1e9);
    if (!points_.empty() && time_ns <= points_.back().time_ns) {
      fail("t '" + std::string{field} + "' is not after the time of line " +
           std::to_string(last_point_line_));
    }
    last_point_line_ = line_number_;
    return time_ns;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw TrajectoryError(file_ + ":" + std::to_string(std::max(line_number_, 1)) + ": " + message);
  }

  const std::string& file_;
  Axes axes_;
  Format format_ = Format::unknown;
  int line_number_ = 0;
  int last_point_line_ = 0;
  std::vector<TrajectoryPoint> points_;
};

/// Time within the trajectory after playing for `elapsed`.
std::int64_t time_in(const Trajectory& trajectory, const Playback& playback,
                     std::chrono::nanoseconds elapsed) {
  const auto duration_ns = static_cast<double>(trajectory.end_ns() - trajectory.start_ns());
  double played_ns =
      static_cast<double>(playback.from_ns) + playback.speed * static_cast<double>(elapsed.count());
  if (playback.loop && duration_ns > 0.0) {
    played_ns = std::fmod(played_ns, duration_ns);
  }
  return played_ns < duration_ns ? trajectory.start_ns() + static_cast<std::int64_t>(played_ns)
                                 : trajectory.end_ns();
}

}  // namespace

Trajectory::Trajectory(std::vector<TrajectoryPoint> points) : points_(std::move(points)) {}

TrajectoryState Trajectory::at(std::int64_t time_ns) const {
  const auto later = std::upper_bound(points_.begin(), points_.end(), time_ns,
                                      [](std::int64_t t, const TrajectoryPoint& p) { return t < p.time_ns; });
  if (later == points_.begin() || later == points_.end()) {
    return {(later == points_.begin() ? points_.front() : points_.back()).T_world_vehicle, {}};
  }
  const TrajectoryPoint& from = *std::prev(later);
  const auto segment_ns = static_cast<double>(later->time_ns - from.time_ns);
  const Transform now = interpolate(from.T_world_vehicle, later->T_world_vehicle,
                                    static_cast<double>(time_ns - from.time_ns) / segment_ns);
  const double per_second = 1e9 / segment_ns;
  const Vec3 world_mps = per_second * (later->T_world_vehicle.position_m - from.T_world_vehicle.position_m);
  const Vec3 turn =
      to_rotation_vector(conjugate(from.T_world_vehicle.orientation) * later->T_world_vehicle.orientation);
  return {now, {rotate(conjugate(now.orientation), world_mps), per_second * turn}};
}

Trajectory parse_trajectory(std::string_view text, const std::string& file, Axes axes) {
  return Parser{file, axes}.parse(text);
}

Trajectory load_trajectory(const std::filesystem::path& file, Axes axes) {
  std::ifstream stream{file, std::ios::binary};
  std::ostringstream text;
  // An empty file sets failbit on `text`, so only the state of `stream` shows whether the file could be read.
  std::error_code why(errno, std::generic_category());
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(file, ignored);
  if (is_folder) {
    why = std::make_error_code(std::errc::is_a_directory);
  }
  if (is_folder || !stream || !(text << stream.rdbuf(), !stream.bad())) {
    throw TrajectoryError(file.string() + ": cannot be read: " + why.message());
  }
  return parse_trajectory(text.str(), file.string(), axes);
}

bool finished(const Trajectory& trajectory, const Playback& playback, std::chrono::nanoseconds elapsed) {
  return !playback.loop && time_in(trajectory, playback, elapsed) >= trajectory.end_ns();
}

PoseSample play(const Trajectory& trajectory, const Playback& playback, std::chrono::nanoseconds elapsed) {
  const TrajectoryState state = trajectory.at(time_in(trajectory, playback, elapsed));
  const Velocity twist{playback.speed * state.twist.linear_mps, playback.speed * state.twist.angular_radps};
  PoseSample sample;
  sample.T_world_vehicle = state.T_world_vehicle;
  // A higher speed is a jump between two points, not a motion to extrapolate.
  if (norm(twist.linear_mps) <= max_speed && norm(twist.angular_radps) <= max_speed) {
    sample.twist = twist;
  }
  return sample;
}

}  // namespace sonard::pose
