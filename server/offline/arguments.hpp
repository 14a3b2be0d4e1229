// The command line of `sonard render`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/config/config.hpp"
#include "server/offline/options.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
class Option;
}  // namespace CLI

namespace sonard::server {

class OfflineArguments {
 public:
  /// Declares the options; `app` and this object then live until it has parsed.
  explicit OfflineArguments(CLI::App& app);

  const std::filesystem::path& config() const { return config_; }
  /// What they mean for a head.
  /// @throws CLI::ValidationError, also for an option that this type of head does not know
  OfflineOptions options(const std::vector<AnyHeadConfig>& heads) const;

 private:
  void declare_run(CLI::App& app);
  void declare_sonar(CLI::App& app);
  void set_gemini(gemini::PingSettings& settings) const;
  void set_micron(micron::ScanSettings& settings) const;

  std::filesystem::path config_;
  OfflineOptions options_;
  // As they are typed, before it is known what head they are for.
  std::string axes_ = "enu_flu";
  std::string shard_ = "0/1";
  std::optional<double> range_m_, gain_percent_, sound_speed_mps_;
  std::optional<int> compression_, bits_;
  std::optional<int> bins_;
  std::optional<double> step_deg_;
  std::vector<double> sector_deg_;
};

}  // namespace sonard::server
