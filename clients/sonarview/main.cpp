// sonarview: talks to a Gemini 720i or a Micron as a vehicle would, and compares images. Usage:
// docs/sonarview.md.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <variant>

#include "clients/sonarview/command_line.hpp"
#include "clients/sonarview/compare/report.hpp"
#include "clients/sonarview/gemini/viewer.hpp"
#include "clients/sonarview/micron/viewer.hpp"

namespace {

using namespace sonard::client;

struct View {
  ExitStatus operator()(const GeminiOptions& options) const { return view_gemini(options); }
  ExitStatus operator()(const MicronOptions& options) const { return view_micron(options); }
  ExitStatus operator()(const CompareOptions& options) const { return compare(options); }
};

}  // namespace

int main(int argc, char** argv) {
  ExitStatus status = ExitStatus::ok;
  const auto command_line = parse_command_line(argc, argv, status);
  if (command_line) {
    try {
      status = std::visit(View{}, *command_line);
    } catch (const std::exception& error) {
      fmt::print(stderr, "sonarview: {}\n", error.what());
      status = ExitStatus::system;
    }
  }
  return static_cast<int>(status);
}
