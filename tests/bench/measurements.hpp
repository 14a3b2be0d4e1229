// SPDX-License-Identifier: Apache-2.0
// What the benchmark found, as the flat list that other tools read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonard::bench {

/// Which sonar in which world, seen by which engine, sampled how.
struct Subject {
  std::string scene;
  std::string engine;  ///< `gpu` or `cpu`
  std::string preset;  ///< name of a point (points.hpp)

  bool operator==(const Subject&) const = default;
};

struct Measurement {
  Subject subject;
  std::string metric;  ///< docs/benchmark.md lists them
  double value;
  std::string unit;  ///< "ms", "1" for ratios, "bins", "count", "MiB"
};

class Measurements {
 public:
  /// A value that is not finite was not measured: it is left out.
  void add(const Subject& subject, const std::string& metric, double value, const std::string& unit);

  std::optional<double> find(const Subject& subject, const std::string& metric) const;
  const std::vector<Measurement>& all() const { return all_; }

  /// A JSON array of {scene, engine, preset, metric, value, unit}.
  std::string to_json() const;

 private:
  std::vector<Measurement> all_;
};

/// Both make the folder too. @throws std::runtime_error naming the file.
void write_text(const std::string& text, const std::filesystem::path& file);
void write_json(const Measurements& measurements, const std::filesystem::path& file);

}  // namespace sonard::bench
