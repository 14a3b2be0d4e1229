// SPDX-License-Identifier: Apache-2.0
// `sonarview ping360`.
#pragma once

#include "clients/sonarview/common/subcommand.hpp"

namespace sonard::client {

const Subcommand& ping360_subcommand();

}  // namespace sonard::client
