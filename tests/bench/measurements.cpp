// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/measurements.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace sonard::bench {

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
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Measurement& m : all_) {
    list.push_back({{"scene", m.subject.scene},
                    {"engine", m.subject.engine},
                    {"preset", m.subject.preset},
                    {"metric", m.metric},
                    {"value", m.value},
                    {"unit", m.unit}});
  }
  return list.dump(1) + "\n";
}

void write_text(const std::string& text, const std::filesystem::path& file) {
  std::error_code ignored;  // if creating the folder fails, opening the file reports it
  std::filesystem::create_directories(file.parent_path(), ignored);
  std::ofstream stream(file);
  stream << text;
  stream.close();
  if (!stream) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

void write_json(const Measurements& measurements, const std::filesystem::path& file) {
  write_text(measurements.to_json(), file);
}

}  // namespace sonard::bench
