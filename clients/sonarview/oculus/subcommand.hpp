// SPDX-License-Identifier: Apache-2.0
// `sonarview oculus`.
#pragma once

#include "clients/sonarview/common/subcommand.hpp"

namespace sonard::client {

const Subcommand& oculus_subcommand();

}  // namespace sonard::client
