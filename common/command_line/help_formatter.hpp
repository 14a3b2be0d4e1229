// SPDX-License-Identifier: Apache-2.0
// Names of option values in `--help`.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace sonard {

/// Prints "NUMBER", "0..100" or "{auto,gpu,cpu}" instead of CLI11's names of types and validators.
class HelpFormatter final : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override;
};

/// Returns the name of an option's values. @param type CLI11's name: "FLOAT:FLOAT in [0 - 100]"
std::string value_text(const std::string& type);

}  // namespace sonard
