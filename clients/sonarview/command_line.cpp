#include "clients/sonarview/command_line.hpp"

#include <CLI/CLI.hpp>
#include <string>

namespace sonard::client {
namespace {

constexpr const char* gemini_footer = R"(Examples:
  sonarview --range 20 --compression 1 --out out          to the head of configs/demo.yaml, until Ctrl-C
  sonarview --continuous 100 --pings 200 --log-pings      pings every 100 ms, one line each
  sonarview --drop-rx 0.05 --drop-tx 0.05 --pings 200     on a link that loses 5 % both ways
  sonarview --surface-address 10.61.19.1                  to a head on another network
  sonarview micron --help                                 to a Micron
  sonarview compare --help                                images against each other

Exit status: 0 all pings complete; 1 a socket or file could not be opened; 2 command line; 3 no head;
4 a ping ended incomplete, or none came.)";

constexpr const char* micron_footer = R"(Examples:
  sonarview micron --tcp 127.0.0.1:4001 --range 20 --out out       all round, until Ctrl-C
  sonarview micron --tty /dev/ttyUSB0 --turns 1 --raw turn.jsonl   one turn, its lines in a file
  sonarview micron --tcp 10.0.0.7:4001 --sector -45 45 --step 0.9  to and fro over 90 degrees ahead

Exit status: 0 all lines came; 1 a file could not be written; 2 command line; 3 no head;
4 lines are missing, or none came.)";

constexpr const char* compare_footer = R"(Examples:
  sonarview compare out/polar-last.png before/polar-last.png
  sonarview compare dump/gemini.csv#12 dump/gemini.csv#13 --json difference.json
  sonarview compare turn.jsonl#0 turn.jsonl#1

Exit status: 0 compared; 1 a file could not be read or written, or the sizes differ; 2 command line.)";

/// An option before the subcommand is for a Gemini, and would be lost in silence.
void refuse_gemini_options(const CLI::App& app, const std::string& subcommand) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() > 0) {
      throw CLI::ValidationError(option->get_name(),
                                 "stands before '" + subcommand + "', whose options follow it");
    }
  }
}

}  // namespace

std::optional<CommandLine> parse_command_line(int argc, const char* const* argv, ExitStatus& status) {
  CLI::App app{
      "Talks to a Gemini 720i as a vehicle would: pings, repairs losses, reports rate and loss, writes "
      "pictures.",
      "sonarview"};
  app.footer(gemini_footer);
  const GeminiArguments gemini(app);
  CLI::App* scanning_head = app.add_subcommand(
      "micron", "Talks to a Micron instead: scans, reports rate and loss, writes pictures and lines.");
  scanning_head->footer(micron_footer);
  const MicronArguments micron(*scanning_head);
  CLI::App* comparison =
      app.add_subcommand("compare", "Says how alike two images are: MSE, PSNR, SSIM, MS-SSIM, SIFT.");
  comparison->footer(compare_footer);
  const CompareArguments compared(*comparison);
  app.require_subcommand(0, 1);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) {
      return gemini.options();
    }
    refuse_gemini_options(app, app.get_subcommands().front()->get_name());
    return comparison->parsed() ? CommandLine(compared.options()) : CommandLine(micron.options());
  } catch (const CLI::ParseError& error) {
    status = app.exit(error) == 0 ? ExitStatus::ok : ExitStatus::usage;
    return std::nullopt;
  }
}

}  // namespace sonard::client
