// SPDX-License-Identifier: Apache-2.0
// The program: command line and log; the one place that maps exceptions to exit codes.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "common/command_line/help_formatter.hpp"
#include "common/text/printable.hpp"
#include "protocol/pose/trajectory.hpp"
#include "renderer/errors.hpp"
#include "renderer/renderer_options.hpp"
#include "server/check.hpp"
#include "server/check_report.hpp"
#include "server/config/loader.hpp"
#include "server/daemon/daemon.hpp"
#include "server/daemon/exhaustion.hpp"
#include "server/daemon/exit_codes.hpp"
#include "server/daemon/process.hpp"
#include "server/demo.hpp"
#include "server/devices/types/types.hpp"
#include "server/error/error.hpp"
#include "server/info/info.hpp"
#include "server/listen.hpp"
#include "server/offline/arguments.hpp"
#include "server/offline/render_run.hpp"
#include "server/program_log/json_lines.hpp"
#include "server/program_log/stderr_sink.hpp"
#include "server/reload.hpp"
#include "server/replay/replay.hpp"
#include "server/selftest.hpp"
#include "sonard_build_info.hpp"

namespace sonard::server {
namespace {

constexpr const char* exit_code_help =
    "Exit codes:\n"
    "  0   success: ended by SIGINT, SIGTERM or the end of the recording, or no problem found\n"
    "  2   invalid or unreadable configuration, world, trajectory or log\n"
    "  3   an address or port is not available, or an interface has no address (yet)\n"
    "  4   the engine is not available or failed its self-test, or the renderer failed while serving\n"
    "  5   sonard cannot write to a file or folder\n"
    "  64  invalid command line\n"
    "  70  a defect in sonard\n"
    "  71  no more file descriptors, threads or memory";

constexpr const char* check_exit_code_help =
    "Exit codes:\n"
    "  0   no problem found; with --listen: also a pose of the vehicle arrived\n"
    "  2   a problem found, in a file or because an address or port is not available; with --listen: no pose "
    "of the vehicle arrived\n"
    "  3   the only problem is an interface that is missing or has no address (yet); with --listen: a pose "
    "input cannot be opened\n"
    "  64  invalid command line\n"
    "  70  a defect in sonard\n"
    "  71  no more file descriptors, threads or memory";

struct CommandLine {
  std::filesystem::path config;
  std::string log_level;   ///< empty: from the configuration
  std::string log_format;  ///< empty: from the configuration
  bool json = false;       ///< of check and selftest
  bool no_network = false;
  double listen_s = 0.0;  ///< 0: check does not listen
  render::RendererOptions selftest;
  std::string selftest_engine = "auto";
  std::filesystem::path log;  ///< of replay and info
  ReplayTiming timing;
  InfoOptions info;
  DemoOptions demo;
  int demo_s = 0;  ///< 0: until a signal
};

spdlog::level::level_enum spdlog_level(LogLevel level) {
  switch (level) {
    case LogLevel::trace:
      return spdlog::level::trace;
    case LogLevel::debug:
      return spdlog::level::debug;
    case LogLevel::info:
      return spdlog::level::info;
    case LogLevel::warn:
      return spdlog::level::warn;
    case LogLevel::error:
      break;
  }
  return spdlog::level::err;
}

/// Logs one line per event to stderr, in UTC.
void start_log() {
  const auto sink = std::make_shared<StderrSink>();
  auto logger = std::make_shared<spdlog::logger>("sonard", sink);
  logger->set_error_handler([sink](const std::string&) { sink->drop_line(); });
  spdlog::set_default_logger(std::move(logger));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
}

/// Prints a problem without a log prefix, so that editors can jump to the place it names. In JSON mode it is
/// a JSON line like the others.
bool logs_json = false;
void print_error(const std::string& line) {
  if (logs_json) {
    spdlog::error("{}", line);
  } else {
    fmt::print(stderr, "{}\n", printable(line));
  }
}

void set_log(const std::string& level, const std::string& format) {
  spdlog::set_level(spdlog::level::from_str(level));
  logs_json = format == "json";
  if (logs_json) {
    spdlog::set_formatter(std::make_unique<JsonLines>());
  }
}

/// What the error handler needs to know of the running command.
struct Run {
  /// Gives the places of keys; nullopt: the command reads no configuration, or shows no places.
  std::optional<LoadedConfig> loaded;
  /// Called with the reason if the command cannot go on; may be empty.
  std::function<void(const std::string& why)> go_back;
};

/// Loads CONFIG and sets up the log as configured.
/// @param text of CONFIG
LoadedConfig load_and_log(const CommandLine& arguments, const std::string& text) {
  if (!arguments.log_format.empty()) {
    set_log(arguments.log_level.empty() ? "info" : arguments.log_level, arguments.log_format);
  }
  LoadedConfig loaded = load_config(arguments.config, text, head_types());
  const std::string level{spdlog::level::to_string_view(spdlog_level(loaded.config.log.level)).data()};
  const std::string format = loaded.config.log.format == LogFormat::json ? "json" : "text";
  set_log(arguments.log_level.empty() ? level : arguments.log_level,
          arguments.log_format.empty() ? format : arguments.log_format);
  spdlog::info("sonard " SONARD_BUILD_INFO ": {}", arguments.config.string());
  for (const std::string& warning : loaded.warning_lines()) {
    spdlog::warn("{}", warning);
  }
  return loaded;
}

/// @param argv of main()
int run(const CommandLine& arguments, char** argv, Run& running) {
  const InheritedConfig inherited = inherit_config();
  if (inherited.fallback) {
    running.go_back = [fallback = *inherited.fallback, argv](const std::string& why) {
      spdlog::error("the new configuration failed, returning to the previous one: {}", why);
      go_back_to(fallback, argv);
    };
  }
  const std::string text = inherited.text ? *inherited.text : read_config(arguments.config);
  const LoadedConfig& loaded = running.loaded.emplace(load_and_log(arguments, text));
  Reload reload(loaded.config, text);
  const int code = run_daemon(loaded.config, [&](const std::stop_token& stop) { return reload.check(stop); });
  if (code != begins_anew) {
    return code;
  }
  reload.begin_anew(argv);
  return exit_clean;
}

int replay(const CommandLine& arguments, Run& running) {
  if (arguments.config.empty()) {
    set_log(arguments.log_level.empty() ? "info" : arguments.log_level, arguments.log_format);
    return replay(arguments.log, std::nullopt, arguments.timing);
  }
  running.loaded = load_and_log(arguments, read_config(arguments.config));
  return replay(arguments.log, running.loaded->config, arguments.timing);
}

/// @throws ConfigError, unless it is printed as JSON
int check(const CommandLine& arguments) {
  const auto json_goes_out = [](const std::string& json) { fmt::print("{}\n", json); };
  try {
    const InheritedConfig inherited = inherit_config();
    const LoadedConfig loaded = load_config(
        arguments.config, inherited.text ? *inherited.text : read_config(arguments.config), head_types());
    const CheckReport report = check_config(loaded, !arguments.no_network);
    const int code = report.problems.empty() ? exit_clean : exit_config;
    if (arguments.json) {
      json_goes_out(report_json(arguments.config, report));
      return code;
    }
    print_report(arguments.config, report);
    if (code == exit_clean && arguments.listen_s > 0.0) {
      spdlog::set_level(spdlog::level::warn);  // the report already shows the senders
      return listen_to_poses(report.config, *report.world,
                             std::chrono::nanoseconds(std::llround(1e9 * arguments.listen_s)));
    }
    return code;
  } catch (const ConfigError& error) {
    if (!arguments.json) {
      throw;
    }
    json_goes_out(report_json(arguments.config, error));
    return exit_code_of(error.kind);
  }
}

int render_offline(const OfflineArguments& arguments, Run& running) {
  const LoadedConfig& loaded = running.loaded.emplace(load_config(arguments.config(), head_types()));
  for (const std::string& warning : loaded.warning_lines()) {
    print_error("warning: " + warning);
  }
  return render_trajectory(loaded, arguments.options());
}

/// Converts any exception to an Error. Exceptions of libraries and of rooms below the server have no kind.
Error as_error(const std::exception& error) {
  if (const auto* known = dynamic_cast<const Error*>(&error)) {
    return *known;
  }
  if (dynamic_cast<const pose::TrajectoryError*>(&error) != nullptr) {
    return {ErrorKind::configuration, error.what()};
  }
  if (dynamic_cast<const render::RequestError*>(&error) != nullptr) {
    return {ErrorKind::configuration, fmt::format("cannot render: {}", error.what())};
  }
  if (dynamic_cast<const render::RendererError*>(&error) != nullptr) {
    return {ErrorKind::renderer, fmt::format("renderer: {}", error.what())};
  }
  if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr) {
    return {ErrorKind::usage, error.what()};  // of an option whose meaning depends on the configuration
  }
  if (const auto sentence = exhausted(error)) {
    return {ErrorKind::exhausted, *sentence};
  }
  return {ErrorKind::internal, fmt::format("defect: {}", error.what())};
}

/// Runs a command; prints its error, if any, and maps it to an exit code.
int guarded(Run& running, const std::function<int()>& command) {
  try {
    return command();
  } catch (const std::exception& exception) {
    const Error error = as_error(exception);
    for (const std::string& line : error.lines()) {
      print_error(running.loaded && !error.where.empty() ? running.loaded->problem_with(error.where, line)
                                                         : line);
    }
    const int code = exit_code_of(error.kind);
    if (const auto go_back = std::exchange(running.go_back, {})) {
      return guarded(running, [&] {
        go_back(exception.what());
        return code;
      });
    }
    return code;
  }
}

/// For --help, which must work even if only the program was copied.
std::string names_of_demos() {
  try {
    return fmt::format("NAME is one of: {}", fmt::join(demo_names(), ", "));
  } catch (const std::exception&) {
    return "NAME is an entry of demo/list.yaml in the folder of configurations, which was not found.";
  }
}

void add_log_format(CLI::App& command, std::string& format) {
  command
      .add_option("--log-format", format, "Format of the log on stderr: text, or one JSON object per line")
      ->check(CLI::IsMember({"text", "json"}));
}

render::EngineKind engine_named(const std::string& name) {
  using render::EngineKind;
  return name == "gpu" ? EngineKind::gpu : name == "cpu" ? EngineKind::cpu : EngineKind::automatic;
}

/// What a command line without a subcommand gets to read.
/// @param first its first word; may be empty
std::string missing_subcommand(const CLI::App& app, const std::filesystem::path& first) {
  std::vector<std::string> names;
  for (const CLI::App* const subcommand : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(subcommand->get_name());
  }
  const std::string expected = fmt::format("(expected one of: {})", fmt::join(names, ", "));
  if (first.empty()) {
    return fmt::format("a subcommand is missing {}", expected);
  }
  const std::string word = printable(first.string());
  const std::string suffix = first.extension().string();
  const bool is_log =
      suffix == ".glf" || suffix == ".dat" || suffix == ".mcap" || suffix == ".pcapng" || suffix == ".sonar";
  return suffix == ".yaml" || suffix == ".yml"
             ? fmt::format("'{0}' is not a subcommand; 'sonard run {0}' runs a configuration {1}", word,
                           expected)
         : is_log
             ? fmt::format("'{0}' is not a subcommand; 'sonard info {0}' shows a log {1}", word, expected)
             : fmt::format("'{}' is not a subcommand {}", word, expected);
}

int main_program(int argc, char** argv) {
  CLI::App app{"sonard - emulates imaging sonars on the network, rendered from a 3D world", "sonard"};
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", std::string("sonard " SONARD_BUILD_INFO));
  app.footer(exit_code_help);
  app.require_subcommand(1);

  CommandLine arguments;
  CLI::App* run_command =
      app.add_subcommand("run", "Serve the heads of a configuration until SIGINT or SIGTERM");
  run_command->add_option("CONFIG", arguments.config, "YAML file (docs/configuration.md)")->required();
  run_command->add_option("--log-level", arguments.log_level, "Log level; overrides the one in CONFIG")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error"}));

  add_log_format(*run_command, arguments.log_format);

  CLI::App* demo_command = app.add_subcommand(
      "demo", "Run the demo: the daemon, moving poses, a client, and a page in the browser");
  demo_command->add_option("NAME", arguments.demo.name, "Demo to run; default: the first name below");
  demo_command->footer(names_of_demos);
  demo_command->add_option("--out", arguments.demo.out, "Folder for pictures and the output of the programs");
  demo_command->add_option("--seconds", arguments.demo_s, "End after this many seconds; default: at Ctrl-C")
      ->check(CLI::Range(1, 1'000'000));

  CLI::App* check_command =
      app.add_subcommand("check", "Validate a configuration with its world, trajectory and addresses");
  check_command->add_option("CONFIG", arguments.config, "YAML file (docs/configuration.md)")->required();
  check_command->add_flag("--no-network", arguments.no_network,
                          "Do not test whether the addresses can be bound here");
  check_command
      ->add_option("--listen", arguments.listen_s,
                   "Then listen to the pose inputs for this many seconds and report the poses that arrive")
      ->check(CLI::Range(0.1, 86'400.0))
      ->excludes(check_command->add_flag(
          "--json", arguments.json, "Print one JSON object on stdout (docs/deploy.md); not with --listen"));

  CLI::App* render_command = app.add_subcommand(
      "render", "Render a trajectory to pictures, arrays and a log, without serving (docs/offline.md)");
  OfflineArguments offline(*render_command);

  CLI::App* selftest_command = app.add_subcommand(
      "selftest",
      "List the devices that can render here, compare a scene with its closed form, and time both engines");
  selftest_command->add_option("--engine", arguments.selftest_engine, "Engine to test; auto: both")
      ->check(CLI::IsMember({"auto", "gpu", "cpu"}))
      ->capture_default_str();
  selftest_command->add_flag("--json", arguments.json, "Print one JSON object on stdout (docs/deploy.md)");
  selftest_command->add_option("--gpu-device", arguments.selftest.gpu.device,
                               "Number of an EGL device, or a part of its name, as in the key gpu.device");

  CLI::App* replay_command =
      app.add_subcommand("replay", "Serve a recorded .glf, .dat or .mcap as the device that produced it");
  replay_command->add_option("LOG", arguments.log, "The log to serve (docs/logs.md)")->required();
  replay_command->add_option(
      "--config", arguments.config,
      "YAML file with addresses and timing of the heads; default: the heads are on loopback");
  CLI::Option* speed =
      replay_command
          ->add_option("--speed", arguments.timing.speed, "Playback speed; 2 is twice as fast as recorded")
          ->check(CLI::Range(1e-3, 1e3))
          ->capture_default_str();
  replay_command
      ->add_flag("--as-fast-as-asked", arguments.timing.as_asked,
                 "Send the next ping whenever a client requests one; ignore the times of the recording")
      ->excludes(speed);
  replay_command->add_flag("--loop", arguments.timing.loop,
                           "Start again after the last ping, until SIGINT or SIGTERM");
  bool start_now = false;
  replay_command
      ->add_option_function<std::string>(
          "--start", [&start_now](const std::string& when) { start_now = when == "now"; },
          "ping: time starts at the first ping that a client requests, and waits for clients; now: time "
          "starts at once, and pings that no client requests in time are skipped")
      ->check(CLI::IsMember({"ping", "now"}))
      ->default_str("ping");
  replay_command->add_option("--log-level", arguments.log_level, "Log level")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error"}));

  add_log_format(*replay_command, arguments.log_format);

  CLI::App* info_command =
      app.add_subcommand("info", "Show the contents of a .glf, .dat, .mcap, .pcapng or .sonar");
  info_command->add_option("LOG", arguments.log, "The log (docs/logs.md)")->required();
  info_command->add_flag("--json", arguments.info.json, "Print JSON");
  CLI::Option* pictures = info_command->add_option("--png", arguments.info.pictures,
                                                   "Folder for a picture of each ping or sweep");
  info_command->add_option("--every", arguments.info.every, "Write a picture every N pings or sweeps only")
      ->needs(pictures)
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000}));
  info_command
      ->add_option("--utc-offset", arguments.info.utc_offset_h,
                   "Hours that the clock of a .glf was ahead of UTC; default: this machine's time zone")
      ->check(CLI::Range(-14.0, 14.0));

  for (CLI::App* command :
       {run_command, demo_command, render_command, replay_command, info_command, selftest_command}) {
    command->footer(exit_code_help);
  }
  check_command->footer(check_exit_code_help);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool has_option = argc > 1 && argv[1][0] == '-';
    if (app.get_subcommands().empty() && !has_option) {
      const std::filesystem::path first = argc > 1 ? argv[1] : "";
      fmt::print(stderr, "{}\n", missing_subcommand(app, first));
      return exit_usage;
    }
    return app.exit(error) == 0 ? exit_clean : exit_usage;
  }
  arguments.timing.start_now = start_now;
  start_log();
  if (run_command->parsed() || replay_command->parsed()) {
    ignore_harmless_signals();
    let_orders_to_end();
  }
  Run running;
  return guarded(running, [&] {
    if (run_command->parsed()) {
      return run(arguments, argv, running);
    }
    if (demo_command->parsed()) {
      if (arguments.demo_s > 0) {
        arguments.demo.time = std::chrono::seconds(arguments.demo_s);
      }
      return run_demo(arguments.demo);
    }
    if (render_command->parsed()) {
      return render_offline(offline, running);
    }
    if (info_command->parsed()) {
      info(arguments.log, arguments.info);
      return static_cast<int>(exit_clean);
    }
    if (replay_command->parsed()) {
      return replay(arguments, running);
    }
    if (check_command->parsed()) {
      return check(arguments);
    }
    arguments.selftest.engine = engine_named(arguments.selftest_engine);
    return selftest(arguments.selftest, arguments.json);
  });
}

}  // namespace
}  // namespace sonard::server

int main(int argc, char** argv) {
  sonard::server::open_standard_descriptors();
  sonard::server::end_by_sentence_when_exhausted();
  return sonard::server::main_program(argc, argv);
}
