// The program: command line, log, and the one place where exceptions become exit codes.
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "protocol/pose/trajectory.hpp"
#include "renderer/errors.hpp"
#include "renderer/sonar_renderer.hpp"
#include "server/check.hpp"
#include "server/config/loader.hpp"
#include "server/daemon.hpp"
#include "server/exit_codes.hpp"
#include "server/offline/arguments.hpp"
#include "server/offline/output_folder.hpp"
#include "server/offline/render_run.hpp"
#include "server/offline/voyage.hpp"

namespace sonard::server {
namespace {

constexpr const char* exit_code_help =
    "Exit codes:\n"
    "  0   ended by SIGINT or SIGTERM, or nothing to complain about\n"
    "  2   configuration, world or trajectory cannot be used\n"
    "  3   an address or port cannot be used\n"
    "  4   the backend asked for cannot be had, failed self-test, or the renderer failed while serving\n"
    "  5   a file or folder to write to cannot be used\n"
    "  64  wrong command line\n"
    "  70  a defect of this program";

struct CommandLine {
  std::filesystem::path config;
  std::string log_level;  ///< empty: as the configuration says
  bool no_network = false;
  render::Backend backend = render::Backend::automatic;  ///< of selftest
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

/// One line per event on stderr, UTC.
void start_log() {
  auto logger = std::make_shared<spdlog::logger>("sonard", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->flush_on(spdlog::level::trace);
  spdlog::set_default_logger(std::move(logger));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
}

/// Problems go out bare, so that editors can jump to the place they name.
void print_error(const std::string& line) {
  fmt::print(stderr, "{}\n", line);
}

int run(const CommandLine& arguments) {
  const LoadedConfig loaded = load_config(arguments.config);
  const spdlog::level::level_enum level = arguments.log_level.empty()
                                              ? spdlog_level(loaded.config.log_level)
                                              : spdlog::level::from_str(arguments.log_level);
  spdlog::set_level(level);
  for (const std::string& warning : loaded.warnings) {
    spdlog::warn("{}", warning);
  }
  try {
    return run_daemon(loaded.config);
  } catch (const StartError& error) {
    print_error(loaded.problem_with(error.key, error.what()));
    return error.exit_code;
  }
}

int check(const CommandLine& arguments) {
  const LoadedConfig loaded = load_config(arguments.config);
  const CheckReport report = check_config(loaded, !arguments.no_network);
  for (const std::string& line : report.summary) {
    fmt::print("{}\n", line);
  }
  for (const std::string& warning : report.warnings) {
    print_error("warning: " + warning);
  }
  for (const std::string& problem : report.problems) {
    print_error(problem);
  }
  if (report.problems.empty()) {
    fmt::print("{}: good\n", arguments.config.string());
    return exit_clean;
  }
  fmt::print("{}: {} problem{}\n", arguments.config.string(), report.problems.size(),
             report.problems.size() == 1 ? "" : "s");
  return exit_config;
}

int selftest(const CommandLine& arguments) {
  const render::RendererOptions options{arguments.backend, 0};
  try {
    fmt::print("backend  {}\n", render::SonarRenderer(render::World{}, options).backend_description());
    fmt::print("wall     {:.3f} % RMS from its closed form\n", 100.0 * render::run_self_test(options));
  } catch (const render::RendererError&) {
    fmt::print("FAIL\n");
    throw;
  }
  fmt::print("PASS\n");
  return exit_clean;
}

int render_offline(const OfflineArguments& arguments) {
  const LoadedConfig loaded = load_config(arguments.config());
  for (const std::string& warning : loaded.warnings) {
    print_error("warning: " + warning);
  }
  try {
    return render_trajectory(loaded, arguments.options(loaded.config.heads));
  } catch (const StartError& error) {
    print_error(loaded.problem_with(error.key, error.what()));
    return error.exit_code;
  }
}

/// The command, with what it throws turned into its exit code.
template <typename Command>
int guarded(const Command& command) {
  try {
    return command();
  } catch (const ConfigError& error) {
    for (const std::string& line : error.lines()) {
      print_error(line);
    }
    return exit_config;
  } catch (const pose::TrajectoryError& error) {
    print_error(error.what());
    return exit_config;
  } catch (const render::RequestError& error) {
    print_error(fmt::format("cannot render: {}", error.what()));
    return exit_config;
  } catch (const TooManyPings& error) {
    print_error(error.what());
    return exit_usage;
  } catch (const OutputError& error) {
    print_error(error.what());
    return exit_output;
  } catch (const CLI::ValidationError& error) {  // of an option whose meaning depends on the configuration
    print_error(error.what());
    return exit_usage;
  } catch (const render::RendererError& error) {
    print_error(fmt::format("renderer: {}", error.what()));
    return exit_renderer;
  } catch (const std::exception& error) {
    print_error(fmt::format("defect: {}", error.what()));
    return exit_internal;
  }
}

int main_program(int argc, char** argv) {
  CLI::App app{"sonard - an imaging sonar on the network, rendered from a 3D world", "sonard"};
  app.set_version_flag("--version", std::string("sonard " SONARD_VERSION));
  app.footer(exit_code_help);
  app.require_subcommand(1);

  CommandLine arguments;
  CLI::App* run_command =
      app.add_subcommand("run", "Serve the heads of a configuration until SIGINT or SIGTERM");
  run_command->add_option("CONFIG", arguments.config, "YAML file (docs/configuration.md)")->required();
  run_command->add_option("--log-level", arguments.log_level, "Instead of the one in CONFIG")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error"}));

  CLI::App* check_command =
      app.add_subcommand("check", "Validate a configuration with its world, trajectory and addresses");
  check_command->add_option("CONFIG", arguments.config, "YAML file (docs/configuration.md)")->required();
  check_command->add_flag("--no-network", arguments.no_network,
                          "Do not try whether the addresses can be bound here");

  CLI::App* render_command = app.add_subcommand(
      "render", "Render a trajectory to pictures, arrays and a log, without serving (docs/offline.md)");
  OfflineArguments offline(*render_command);

  CLI::App* selftest_command = app.add_subcommand(
      "selftest", "Show the backend in use and compare one known scene with its closed form");
  selftest_command->add_option("--backend", arguments.backend, "auto, raster or ray")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, render::Backend>{{"auto", render::Backend::automatic},
                                                                         {"raster", render::Backend::raster},
                                                                         {"ray", render::Backend::ray}}));
  for (CLI::App* command : {run_command, check_command, render_command, selftest_command}) {
    command->footer(exit_code_help);
  }

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_clean : exit_usage;
  }
  start_log();
  return guarded([&] {
    if (run_command->parsed()) {
      return run(arguments);
    }
    if (render_command->parsed()) {
      return render_offline(offline);
    }
    return check_command->parsed() ? check(arguments) : selftest(arguments);
  });
}

}  // namespace
}  // namespace sonard::server

int main(int argc, char** argv) {
  return sonard::server::main_program(argc, argv);
}
