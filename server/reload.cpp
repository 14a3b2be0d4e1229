// SPDX-License-Identifier: Apache-2.0
#include "server/reload.hpp"

#include <unistd.h>

#include <csignal>
#include <string>

#include <spdlog/spdlog.h>

#include "server/boost_process.hpp"

namespace sonard::server {

bool configuration_is_good(const std::filesystem::path& config) {
  process::ipstream problems;
  process::child check("/proc/self/exe", "check", "--no-network", config.string(),
                       process::std_in<process::null, process::std_out> process::null,
                       process::std_err > problems);
  for (std::string line; std::getline(problems, line);) {
    spdlog::warn("{}", line);
  }
  check.wait();
  return check.exit_code() == 0;
}

void begin_anew(char** argv) {
  std::signal(SIGHUP, SIG_IGN);  // until the new program has its handler
  ::execv("/proc/self/exe", argv);
}

}  // namespace sonard::server
