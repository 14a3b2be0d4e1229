// SPDX-License-Identifier: Apache-2.0
// `sonarview compare`.
#pragma once

#include "clients/sonarview/common/subcommand.hpp"

namespace sonard::client {

const Subcommand& compare_subcommand();

}  // namespace sonard::client
