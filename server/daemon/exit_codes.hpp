// SPDX-License-Identifier: Apache-2.0
// Exit codes of the daemon's programs, for scripts and service managers.
#pragma once

namespace sonard::server {

inline constexpr int exit_clean = 0;       ///< ended by a signal or the end of the recording, or check passed
inline constexpr int exit_config = 2;      ///< configuration, world, trajectory or log cannot be used
inline constexpr int exit_network = 3;     ///< an address or port cannot be used
inline constexpr int exit_renderer = 4;    ///< no such engine here, or it failed its self-test or later
inline constexpr int exit_output = 5;      ///< a file or folder to write to cannot be used
inline constexpr int exit_usage = 64;      ///< wrong command line
inline constexpr int exit_internal = 70;   ///< a defect of this program
inline constexpr int exit_exhausted = 71;  ///< descriptors, threads or memory have run out

}  // namespace sonard::server
