// SPDX-License-Identifier: Apache-2.0
// `sonarview gemini`.
#pragma once

#include "clients/sonarview/common/subcommand.hpp"

namespace sonard::client {

const Subcommand& gemini_subcommand();

}  // namespace sonard::client
