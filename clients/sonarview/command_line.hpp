// The command line of sonarview: which head, and what the user asks of it; or two images to be
// compared.
#pragma once

#include <optional>
#include <variant>

#include "clients/sonarview/compare/options.hpp"
#include "clients/sonarview/exit_status.hpp"
#include "clients/sonarview/gemini/options.hpp"
#include "clients/sonarview/micron/options.hpp"

namespace sonard::client {

using CommandLine = std::variant<GeminiOptions, MicronOptions, CompareOptions>;

/// nullopt: the program ends with `status`, after --help or an error that has been printed.
std::optional<CommandLine> parse_command_line(int argc, const char* const* argv, ExitStatus& status);

}  // namespace sonard::client
