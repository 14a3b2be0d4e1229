// SPDX-License-Identifier: Apache-2.0
// sonarview: a client program for sonars. Usage: docs/sonarview.md.
#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "clients/sonarview/command_line.hpp"
#include "common/text/printable.hpp"

int main(int argc, char** argv) {
  using namespace sonard::client;
  ExitStatus status = ExitStatus::ok;
  if (const auto run = parse_command_line(argc, argv, status)) {
    try {
      status = (*run)();
    } catch (const std::exception& error) {
      fmt::print(stderr, "sonarview: {}\n", sonard::printable(error.what()));
      status = ExitStatus::system;
    }
  }
  return static_cast<int>(status);
}
