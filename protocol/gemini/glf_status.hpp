// SPDX-License-Identifier: Apache-2.0
// A status packet in the fields that a .glf log has (docs/logs.md 1.5).
#pragma once

#include "protocol/gemini/messages.hpp"
#include "protocol/glf/records.hpp"

namespace sonard::gemini {

/// Temperatures of amplifiers that a 720i does not have are 0. The origin is left to the log.
glf::StatusRecord glf_status(const Status& status);

}  // namespace sonard::gemini
