// SPDX-License-Identifier: Apache-2.0
// Exit codes of the daemon's programs, for scripts and service managers.
#pragma once

#include "server/error/error.hpp"

namespace sonard::server {

inline constexpr int exit_clean = 0;       ///< ended by a signal or the end of the recording, or check passed
inline constexpr int exit_config = 2;      ///< configuration, world, trajectory or log cannot be used
inline constexpr int exit_network = 3;     ///< an address or port cannot be used
inline constexpr int exit_renderer = 4;    ///< no such engine here, or it failed its self-test or later
inline constexpr int exit_output = 5;      ///< a file or folder to write to cannot be used
inline constexpr int exit_usage = 64;      ///< wrong command line
inline constexpr int exit_internal = 70;   ///< a defect of this program
inline constexpr int exit_exhausted = 71;  ///< descriptors, threads or memory have run out

inline int exit_code_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::configuration:
      return exit_config;
    case ErrorKind::network:
      return exit_network;
    case ErrorKind::renderer:
      return exit_renderer;
    case ErrorKind::output:
      return exit_output;
    case ErrorKind::usage:
      return exit_usage;
    case ErrorKind::exhausted:
      return exit_exhausted;
    case ErrorKind::internal:
      break;
  }
  return exit_internal;
}

}  // namespace sonard::server
