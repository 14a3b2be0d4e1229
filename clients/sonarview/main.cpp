// sonarview: talks to a Gemini 720i as a vehicle would. Usage: docs/sonarview.md.
#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "clients/sonarview/options.hpp"
#include "clients/sonarview/viewer.hpp"

int main(int argc, char** argv) {
  using sonard::client::ExitStatus;
  ExitStatus status = ExitStatus::ok;
  const auto options = sonard::client::parse_options(argc, argv, status);
  if (options) {
    try {
      status = sonard::client::view(*options);
    } catch (const std::exception& error) {
      fmt::print(stderr, "sonarview: {}\n", error.what());
      status = ExitStatus::system;
    }
  }
  return static_cast<int>(status);
}
