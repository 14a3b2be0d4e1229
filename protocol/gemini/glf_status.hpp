// SPDX-License-Identifier: Apache-2.0
// Converts a status packet to the fields of a .glf log (protocol/glf/README.md 1.5).
#pragma once

#include "protocol/gemini/messages.hpp"
#include "protocol/glf/records.hpp"

namespace sonard::gemini {

/// Converts a status packet. Temperatures of missing amplifiers are 0. The log sets the origin.
glf::StatusRecord glf_status(const Status& status);

}  // namespace sonard::gemini
