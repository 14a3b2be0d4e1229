// SPDX-License-Identifier: Apache-2.0
// What the user asks of sonarview for a Gemini 720i.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/common/endpoint.hpp"
#include "protocol/gemini/ping_settings.hpp"
#include "protocol/gemini/topside.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct GeminiOptions {
  Ipv4 topside_address = 0;                 ///< commands leave from here; 0: from what routes to the head
  Ipv4 bind_address = 0;                    ///< reports arrive here; 0: on all addresses
  gemini::TopsideConfig topside;            ///< for each head with its ID in the place of sonar_id
  std::vector<std::uint16_t> sonar_ids{0};  ///< the heads to talk to; 0: the first whose status arrives
  gemini::PingSettings settings;

  std::uint64_t pings = 0;                 ///< 0: without limit
  std::chrono::nanoseconds duration{};     ///< from the first status; 0: without limit
  std::chrono::nanoseconds status_wait{};  ///< patience for the first status
  std::chrono::nanoseconds ping_wait{};    ///< patience for the next ping; 0: without limit

  std::filesystem::path out;  ///< folder for pictures; empty: none
  std::uint64_t every = 0;    ///< a picture of each n-th ping; 0: only of the last
  int radius_px = 900;        ///< of the fan
  bool log_pings = false;
  bool quiet = false;

  double drop_rx = 0.0;  ///< share of datagrams lost on purpose, 0..1
  double drop_tx = 0.0;
  std::uint64_t seed = 1;
};

/// The options of the program without a subcommand.
class GeminiArguments {
 public:
  /// Declares them; `app` and this object then live until it has parsed.
  explicit GeminiArguments(CLI::App& app);

  /// What they mean.
  /// @throws CLI::ValidationError
  GeminiOptions options() const;

 private:
  void declare_link(CLI::App& app);
  void declare_sonar(CLI::App& app);
  void declare_run(CLI::App& app);

  GeminiOptions options_;
  // As they are typed, before they have their units.
  std::string topside_address_;
  std::string bind_address_ = "0.0.0.0";
  std::string head_address_;
  int bits_ = 8;
  double interval_ms_ = 0.0;
  double seconds_ = 0.0;
  double status_wait_s_ = 5.0;
  double ping_wait_s_ = 30.0;
};

}  // namespace sonard::client
