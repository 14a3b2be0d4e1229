// SPDX-License-Identifier: Apache-2.0
// The tables of docs/events.md.
#pragma once

#include <string>

namespace sonard::server {

/// One table for each type of device and for each transport.
std::string events_reference();

}  // namespace sonard::server
