// SPDX-License-Identifier: Apache-2.0
// The records of a .glf log (docs/logs.md 1.4, 1.5), made of what any multibeam head sends. Pure: a caller
// that has a ping, serving, rendering a trajectory or playing a log back, gets the same record.
#pragma once

#include <cstdint>

#include "protocol/common/ping_record.hpp"
#include "protocol/glf/records.hpp"

namespace sonard::server {

/// Clock and identity of the log that a record goes into.
struct GlfLogOrigin {
  std::int32_t utc_offset_s = 0;  ///< of the zone of the log, the same for all of it
  std::uint8_t number = 0;        ///< 0..9, counted over the heads of a vehicle; makes the node id
  std::uint16_t device_id = 0;
};

/// @param transmit_unix_ns when the pulse left
glf::ImageRecord glf_image(PingRecord ping, std::int64_t transmit_unix_ns, const GlfLogOrigin& origin);

/// The origin of a record at this time.
glf::Origin glf_origin(std::int64_t unix_ns, const GlfLogOrigin& origin);

}  // namespace sonard::server
