// SPDX-License-Identifier: Apache-2.0
// The results of the benchmark, as a flat list that other tools read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonard::bench {

/// The conditions of a measurement: sonar, world, engine and sampling.
struct Subject {
  std::string scene;
  std::string engine;  ///< `gpu` or `cpu`
  std::string preset;  ///< name of a point (points.hpp)

  bool operator==(const Subject&) const = default;
};

struct Measurement {
  Subject subject;
  std::string metric;  ///< listed in tests/bench/README.md
  double value;
  std::string unit;  ///< "ms", "1" for ratios, "bins", "count", "MiB"
};

class Measurements {
 public:
  /// Adds a value. Values that are not finite were not measured and are left out.
  void add(const Subject& subject, const std::string& metric, double value, const std::string& unit);

  std::optional<double> find(const Subject& subject, const std::string& metric) const;
  const std::vector<Measurement>& all() const { return all_; }

  /// A JSON array of {scene, engine, preset, metric, value, unit}.
  std::string to_json() const;

 private:
  std::vector<Measurement> all_;
};

/// Writes a file and creates its folder. @throws std::runtime_error that names the file
void write_text(const std::string& text, const std::filesystem::path& file);
void write_json(const Measurements& measurements, const std::filesystem::path& file);

}  // namespace sonard::bench
