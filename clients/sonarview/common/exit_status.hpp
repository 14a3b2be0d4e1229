// SPDX-License-Identifier: Apache-2.0
// How sonarview ends, in its documentation and in scripts.
#pragma once

namespace sonard::client {

enum class ExitStatus : int {
  ok = 0,
  system = 1,      ///< a socket or a file could not be opened or written
  usage = 2,       ///< the command line makes no sense
  no_head = 3,     ///< no word of a head came in time
  incomplete = 4,  ///< lines are missing, or nothing came
};

}  // namespace sonard::client
