// SPDX-License-Identifier: Apache-2.0
// All settings of a simulated Micron, as plain values.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "protocol/micron/bins.hpp"
#include "protocol/micron/frame.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// Meaning of a sector with a left limit larger than the right limit (8.3).
enum class LimitsOrder : std::uint8_t {
  clockwise,  ///< clockwise from left to right, through astern
  swapped,    ///< the client has swapped the limits
};

/// Answer of a head to a request for its user blocks (6.4).
enum class UserBlocks : std::uint8_t {
  dst,        ///< 264 bytes, followed by the FPGA data
  dst_alone,  ///< 264 bytes, for clients that do not expect FPGA data
  older,      ///< 175 bytes, from a head that is not a DST
};

/// Section numbers refer to protocol/micron/README.md. Most settings are choices in which drivers or heads
/// differ. The defaults suit most drivers; docs/your-micron-driver.md lists the others. The Device
/// constructor rejects values out of range.
struct DeviceConfig {
  std::uint8_t node = default_head_node;  ///< 1..254 (2.1)
  bool half_duplex = false;               ///< one line per request instead of two (8.1)
  VersionData version;                    ///< its `node` is replaced by the member above (6.1)
  UserBlocks user_blocks = UserBlocks::dst;

  /// True speed of sound at the head, used to convert times to ranges. > 0 (4)
  double water_sound_speed_mps = 1500.0;
  bool mounted_inverted = false;  ///< boot down; correct only if the client sets the invert bit (7.6)

  std::chrono::nanoseconds boot_time{700'000'000};  ///< time without receiving or sending; >= 0, < 1 s (7.1)
  /// Minimum time of centring, even for a head at its centre; 0..15 s. The default is longer than
  /// alive_period, for drivers that need two alives during centring, and short enough for drivers with a
  /// watchdog (7.4).
  std::chrono::nanoseconds least_centring_time{1'200'000'000};
  double seek_speed_rad_s = 1.5707963267948966;          ///< while centring, > 0 (7.4)
  std::chrono::nanoseconds alive_period{1'000'000'000};  ///< > 0 (7.1)
  bool alive_while_scanning = true;                      ///< also send alives while lines are owed (8.5)
  bool alive_after_head_command = true;  ///< send an extra alive in answer to a HeadCommand (7.1)
  bool direction_bit_kept = false;       ///< alives report "off centre" after centring, too (6.2)
  bool clock_follows_client = true;      ///< a SendData with a time sets the clock (7.5)

  NibbleOrder nibble_order = NibbleOrder::high_first;  ///< of 4-bit data (6.3)
  LimitsOrder limits_order = LimitsOrder::clockwise;   ///< (8.3)
  bool always_reports_scan_right = false;              ///< in both directions (8.3)
  int request_cap = 2;                                 ///< maximum number of queued requests, 1..100 (8.2)
  bool requests_survive_head_command = true;           ///< (8.2)

  std::chrono::nanoseconds reconfiguration_time{
      250'000'000};  ///< from parameters to the first ping, >= 0 (8.4)
  /// Maximum of reconfiguration_time plus the turn to a sector, >= 0 (8.4).
  std::chrono::nanoseconds reposition_limit{800'000'000};

  std::uint32_t baud = 115'200;                       ///< of the link; limits the rate of lines; > 0 (8.4)
  std::chrono::nanoseconds line_overhead{3'000'000};  ///< added to listening, turning and sending, >= 0 (8.4)
  /// Time between lines, instead of the time that follows from parameters and link; >= 0. 0: as fast as lines
  /// are rendered.
  std::optional<std::chrono::nanoseconds> line_period;

  /// The head sends only the lines that it is fed (PingFed).
  bool plays_back = false;
  /// A ping begins at NextPingDue if it is owed, and its line leaves when it is rendered. The server observes
  /// NextPing.
  bool simulated_time = false;
};

}  // namespace sonard::micron
