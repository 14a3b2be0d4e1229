// SPDX-License-Identifier: Apache-2.0
// Each fixture with the values that its source gives for it.
#pragma once

#include <string>
#include <vector>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini::testing {

struct CommandExample {
  std::string fixture;
  Command value;
};

struct ReportExample {
  std::string fixture;
  Report value;
};

/// Names the case in test output.
inline void PrintTo(const CommandExample& example, std::ostream* out) {
  *out << example.fixture;
}
inline void PrintTo(const ReportExample& example, std::ostream* out) {
  *out << example.fixture;
}

std::vector<CommandExample> command_examples();
std::vector<ReportExample> report_examples();

}  // namespace sonard::gemini::testing
