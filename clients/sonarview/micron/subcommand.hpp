// SPDX-License-Identifier: Apache-2.0
// `sonarview micron`.
#pragma once

#include "clients/sonarview/common/subcommand.hpp"

namespace sonard::client {

const Subcommand& micron_subcommand();

}  // namespace sonard::client
