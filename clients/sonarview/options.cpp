#include "clients/sonarview/options.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

#include "clients/sonarview/ipv4_text.hpp"

namespace sonard::client {
namespace {

constexpr const char* footer = R"(Examples:
  sonarview --range 20 --compression 1 --out out          to the head of configs/demo.yaml, until Ctrl-C
  sonarview --continuous 100 --pings 200 --log-pings      pings every 100 ms, one line each
  sonarview --drop-rx 0.05 --drop-tx 0.05 --pings 200     on a link that loses 5 % both ways
  sonarview --surface-address 10.61.19.1                  to a head on another network

Exit status: 0 all pings complete; 1 a socket or file could not be opened; 2 command line; 3 no head;
4 a ping ended incomplete, or none came.)";

std::chrono::nanoseconds to_ns(double seconds) {
  return std::chrono::nanoseconds{std::llround(seconds * 1e9)};
}

gemini::Ipv4 address_of(const std::string& option, const std::string& text) {
  const auto address = parse_ipv4(text);
  if (!address) {
    throw CLI::ValidationError(option, "expected an IPv4 address, found '" + text + "'");
  }
  return *address;
}

/// Options as they are typed, before they have their units.
struct Arguments {
  std::string surface_address = "127.0.0.1";
  std::string bind_address = "0.0.0.0";
  std::string head_address;
  int bits = 8;
  double interval_ms = 0.0;
  double seconds = 0.0;
  double status_wait_s = 5.0;
  double ping_wait_s = 30.0;
};

void declare_link(CLI::App& app, Arguments& arguments, Options& options) {
  app.add_option("--surface-address", arguments.surface_address,
                 "Local address that commands leave from, port 52901")
      ->capture_default_str()
      ->group("Link");
  app.add_option("--bind", arguments.bind_address, "Local address on which reports arrive, port 52900")
      ->capture_default_str()
      ->group("Link");
  app.add_option("--head", arguments.head_address,
                 "Address of the head, port 52901; without it, the alternate address that its status names")
      ->group("Link");
  app.add_option("--sonar-id", options.surface.sonar_id, "The head to talk to; 0: the first that is heard")
      ->capture_default_str()
      ->group("Link");
  app.add_option("--wait", arguments.status_wait_s, "Seconds to wait for the first status")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str()
      ->group("Link");
  app.add_option("--ping-wait", arguments.ping_wait_s, "Seconds to wait for the next ping; 0: for ever")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str()
      ->group("Link");
}

void declare_sonar(CLI::App& app, Arguments& arguments, Options& options) {
  auto& settings = options.settings;
  app.add_option("--range", settings.range_m, "Metres")
      ->check(CLI::Range(0.3, 150.0))
      ->capture_default_str()
      ->group("Sonar");
  app.add_option("--gain", settings.gain_percent, "Percent")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str()
      ->group("Sonar");
  app.add_option("--sound-speed", settings.sound_speed_mps, "Metres per second, in which ranges are counted")
      ->check(CLI::Range(1400.0, 1588.0))
      ->capture_default_str()
      ->group("Sonar");
  app.add_option("--compression", settings.compression_log2,
                 "0..4: average 1, 2, 4, 8 or 16 range lines into one")
      ->check(CLI::Range(0, 4))
      ->capture_default_str()
      ->group("Sonar");
  app.add_option("--rle", settings.rle_threshold,
                 "Samples below this become zero and travel run-length coded; 0: off")
      ->check(CLI::Range(0, 255))
      ->capture_default_str()
      ->group("Sonar");
  app.add_option("--bits", arguments.bits, "Bits of a sample")
      ->check(CLI::IsMember({8, 16}))
      ->capture_default_str()
      ->group("Sonar");
  app.add_option(
         "--continuous", arguments.interval_ms,
         "Let the head ping by itself at this interval in milliseconds; without it each ping is asked for")
      ->check(CLI::Range(1.0, 1e6))
      ->group("Sonar");
}

void declare_run(CLI::App& app, Arguments& arguments, Options& options) {
  app.add_option("--pings", options.pings, "End after this many pings; 0: go on")
      ->capture_default_str()
      ->group("Run");
  app.add_option("--seconds", arguments.seconds, "End this many seconds after the first status; 0: go on")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str()
      ->group("Run");
  app.add_option("--out", options.out, "Folder for pictures: the fan in colour, the samples in grey")
      ->group("Run");
  app.add_option("--every", options.every, "Pictures of each n-th ping; 0: only of the last")
      ->capture_default_str()
      ->group("Run");
  app.add_option("--size", options.radius_px, "Pixels from the apex of the fan to its full range")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str()
      ->group("Run");
  app.add_flag("--log-pings", options.log_pings, "One line of key=value for each ping on standard output")
      ->group("Run");
  app.add_flag("--quiet", options.quiet, "No progress on standard error")->group("Run");
  app.add_option("--drop-rx", options.drop_rx, "Share of arriving datagrams to lose on purpose")
      ->check(CLI::Range(0.0, 1.0))
      ->group("Test of the link");
  app.add_option("--drop-tx", options.drop_tx, "Share of leaving datagrams to lose on purpose")
      ->check(CLI::Range(0.0, 1.0))
      ->group("Test of the link");
  app.add_option("--seed", options.seed, "Which datagrams those are")
      ->capture_default_str()
      ->group("Test of the link");
}

void interpret(const Arguments& arguments, Options& options) {
  options.surface_address = address_of("--surface-address", arguments.surface_address);
  options.bind_address = address_of("--bind", arguments.bind_address);
  if (options.surface_address == 0) {
    throw CLI::ValidationError("--surface-address", "must name one address of this machine");
  }
  if (!arguments.head_address.empty()) {
    options.surface.head_address = address_of("--head", arguments.head_address);
  }
  if (options.surface.sonar_id == 1) {
    throw CLI::ValidationError("--sonar-id", "1 is reserved for production");
  }
  options.settings.sixteen_bit = arguments.bits == 16;
  if (arguments.interval_ms > 0.0) {
    options.settings.interval = std::chrono::microseconds{std::llround(arguments.interval_ms * 1e3)};
  }
  options.duration = to_ns(arguments.seconds);
  options.status_wait = to_ns(arguments.status_wait_s);
  options.ping_wait = to_ns(arguments.ping_wait_s);
}

}  // namespace

std::optional<Options> parse_options(int argc, char** argv, ExitStatus& status) {
  CLI::App app{
      "Talks to a Gemini 720i as a vehicle would: pings, repairs losses, reports rate and loss, writes "
      "pictures.",
      "sonarview"};
  app.footer(footer);
  Arguments arguments;
  Options options;
  options.radius_px = 900;
  declare_link(app, arguments, options);
  declare_sonar(app, arguments, options);
  declare_run(app, arguments, options);
  try {
    app.parse(argc, argv);
    interpret(arguments, options);
  } catch (const CLI::ParseError& error) {
    status = app.exit(error) == 0 ? ExitStatus::ok : ExitStatus::usage;
    return std::nullopt;
  }
  return options;
}

}  // namespace sonard::client
