// What the user asks of sonarview.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "protocol/gemini/ping_settings.hpp"
#include "protocol/gemini/surface.hpp"

namespace sonard::client {

/// Exit status of the program, in its documentation and in scripts.
enum class ExitStatus : int {
  ok = 0,
  system = 1,            ///< a socket or a file could not be opened or written
  usage = 2,             ///< the command line makes no sense
  no_head = 3,           ///< no status of a head came in time
  pings_incomplete = 4,  ///< a ping ended with lines missing, or none came
};

struct Options {
  gemini::Ipv4 surface_address = 0x7F000001;  ///< commands leave from here
  gemini::Ipv4 bind_address = 0;              ///< reports arrive here; 0: on all addresses
  gemini::SurfaceConfig surface;
  gemini::PingSettings settings;

  std::uint64_t pings = 0;                 ///< 0: without limit
  std::chrono::nanoseconds duration{};     ///< from the first status; 0: without limit
  std::chrono::nanoseconds status_wait{};  ///< patience for the first status
  std::chrono::nanoseconds ping_wait{};    ///< patience for the next ping; 0: without limit

  std::filesystem::path out;  ///< folder for pictures; empty: none
  std::uint64_t every = 0;    ///< a picture of each n-th ping; 0: only of the last
  int radius_px = 0;          ///< of the fan
  bool log_pings = false;
  bool quiet = false;

  double drop_rx = 0.0;  ///< share of datagrams lost on purpose, 0..1
  double drop_tx = 0.0;
  std::uint64_t seed = 1;
};

/// nullopt: the program ends with `status`, after --help or an error that has been printed.
std::optional<Options> parse_options(int argc, char** argv, ExitStatus& status);

}  // namespace sonard::client
