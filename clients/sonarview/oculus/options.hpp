// SPDX-License-Identifier: Apache-2.0
// What the user asks of `sonarview oculus`.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "protocol/common/endpoint.hpp"
#include "protocol/oculus/messages.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct OculusOptions {
  std::string head;            ///< address; empty: that of the first status
  std::uint16_t port = 52100;  ///< of the head
  Ipv4 bind_address = 0;       ///< statuses arrive here; 0: on all addresses
  std::uint16_t status_port = 52102;
  oculus::SimpleFire fire;

  std::uint64_t pings = 0;               ///< 0: without limit
  std::chrono::nanoseconds duration{};   ///< from the first word of the head; 0: without limit
  std::chrono::nanoseconds wait{};       ///< patience for a status, or a connection
  std::chrono::nanoseconds ping_wait{};  ///< patience for the next ping; 0: without limit

  std::filesystem::path out;  ///< folder for pictures; empty: none
  std::uint64_t every = 0;    ///< a picture of each n-th ping; 0: only of the last
  int radius_px = 900;        ///< of the fan
  bool log_pings = false;
  bool quiet = false;
};

/// The options of the subcommand.
class OculusArguments {
 public:
  /// Declares them; `app` and this object then live until it has parsed.
  explicit OculusArguments(CLI::App& app);

  /// What they mean.
  /// @throws CLI::ValidationError
  OculusOptions options() const;

 private:
  void declare_link(CLI::App& app);
  void declare_sonar(CLI::App& app);
  void declare_run(CLI::App& app);

  OculusOptions options_;
  // As they are typed, before they have their units.
  std::string bind_address_ = "0.0.0.0";
  std::string frequency_ = "low";
  double range_m_ = 20.0;
  int beams_ = 512;
  int bits_ = 8;
  int rate_hz_ = 10;
  bool row_gains_ = false;
  double seconds_ = 0.0;
  double wait_s_ = 10.0;
  double ping_wait_s_ = 30.0;
};

}  // namespace sonard::client
