// SPDX-License-Identifier: Apache-2.0
// Makes records of a .glf log (protocol/glf/README.md 1.4, 1.5) from pings of any multibeam head. Pure:
// serving, rendering a trajectory and replaying a log give the same record.
#pragma once

#include <cstdint>

#include "protocol/common/ping_record.hpp"
#include "protocol/glf/records.hpp"

namespace sonard::server {

/// Clock and identity of a record's log.
struct GlfLogOrigin {
  std::int32_t utc_offset_s = 0;  ///< of the log's zone, constant for the whole log
  std::uint8_t number = 0;        ///< 0..9, over the heads of a vehicle; sets the node id
  std::uint16_t device_id = 0;
};

/// @param transmit_unix_ns transmit time
glf::ImageRecord glf_image(PingRecord ping, std::int64_t transmit_unix_ns, const GlfLogOrigin& origin);

/// The origin of a record at this time.
glf::Origin glf_origin(std::int64_t unix_ns, const GlfLogOrigin& origin);

}  // namespace sonard::server
