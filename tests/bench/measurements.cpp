// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/measurements.hpp"

#include <fmt/format.h>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace sonard::bench {

namespace {

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
    }
    result += c;
  }
  return result + '"';
}

}  // namespace

void Measurements::add(const Subject& subject, const std::string& metric, double value,
                       const std::string& unit) {
  if (std::isfinite(value)) {
    all_.push_back({subject, metric, value, unit});
  }
}

std::optional<double> Measurements::find(const Subject& subject, const std::string& metric) const {
  for (const Measurement& measurement : all_) {
    if (measurement.metric == metric && measurement.subject == subject) {
      return measurement.value;
    }
  }
  return std::nullopt;
}

std::string Measurements::to_json() const {
  std::string text = "[";
  for (const Measurement& m : all_) {
    text += fmt::format(
        "{}\n{{\"scene\": {}, \"backend\": {}, \"preset\": {}, \"metric\": {}, \"value\": {:.9g}, \"unit\": "
        "{}}}",
        text.size() > 1 ? "," : "", quoted(m.subject.scene), quoted(m.subject.backend),
        quoted(m.subject.preset), quoted(m.metric), m.value, quoted(m.unit));
  }
  return text + "\n]\n";
}

void write_json(const Measurements& measurements, const std::filesystem::path& file) {
  std::error_code ignored;  // a folder that cannot be made shows when the file is opened
  std::filesystem::create_directories(file.parent_path(), ignored);
  std::ofstream stream(file);
  stream << measurements.to_json();
  stream.close();
  if (!stream) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace sonard::bench
