// SPDX-License-Identifier: Apache-2.0
// The exit codes of sonarview. Scripts and docs/sonarview.md rely on the values.
#pragma once

namespace sonard::client {

enum class ExitStatus : int {
  ok = 0,
  system = 1,      ///< a socket or a file could not be opened or written
  usage = 2,       ///< invalid command line
  no_head = 3,     ///< nothing was received from a head in time
  incomplete = 4,  ///< lines are missing, or no ping arrived
};

}  // namespace sonard::client
