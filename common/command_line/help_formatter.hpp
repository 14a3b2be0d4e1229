// SPDX-License-Identifier: Apache-2.0
// How `--help` names the values of an option.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace sonard {

/// Prints "NUMBER", "0..100" or "{auto,gpu,cpu}" where CLI11 prints its own names of types and validators.
class HelpFormatter final : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override;
};

/// @param type what CLI11 calls the values: "FLOAT:FLOAT in [0 - 100]"
std::string value_text(const std::string& type);

}  // namespace sonard
