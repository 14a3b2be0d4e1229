// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/command_line.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/command_line/help_formatter.hpp"
#include "sonard_build_info.hpp"

namespace sonard::client {
namespace {

/// Rejects options before a subcommand: they belong to the default device and would be ignored silently.
void refuse_options_before(const CLI::App& app, const std::string& subcommand) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() > 0) {
      throw CLI::ValidationError(option->get_name(),
                                 "is before '" + subcommand + "'; write options after it");
    }
  }
}

}  // namespace

std::optional<Run> parse_command_line(int argc, const char* const* argv, ExitStatus& status) {
  const std::span<const Subcommand> devices = device_subcommands();
  CLI::App app{devices.front().summary, "sonarview"};
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", std::string("sonarview " SONARD_BUILD_INFO));
  app.footer(devices.front().footer);
  const Prepare usual = devices.front().declare(app);
  std::vector<std::pair<CLI::App*, Prepare>> choices;
  const auto add = [&](const Subcommand& subcommand) {
    CLI::App* const declared = app.add_subcommand(subcommand.name, subcommand.summary);
    declared->footer(subcommand.footer);
    choices.emplace_back(declared, subcommand.declare(*declared));
  };
  for (const Subcommand& device : devices) {
    add(device);
  }
  app.require_subcommand(0, 1);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) {
      return usual();
    }
    refuse_options_before(app, app.get_subcommands().front()->get_name());
    for (const auto& [declared, prepare] : choices) {
      if (declared->parsed()) {
        return prepare();
      }
    }
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    status = app.exit(error) == 0 ? ExitStatus::ok : ExitStatus::usage;
    return std::nullopt;
  }
}

}  // namespace sonard::client
