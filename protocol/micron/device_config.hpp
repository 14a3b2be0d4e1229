// SPDX-License-Identifier: Apache-2.0
// Everything a user may set about a simulated Micron, as plain values.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "protocol/micron/bins.hpp"
#include "protocol/micron/frame.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// What a sector is whose left limit is the larger number (8.3).
enum class LimitsOrder : std::uint8_t {
  clockwise,  ///< it still runs clockwise from left to right, through astern
  swapped,    ///< the host has confused them
};

/// What a head says of itself when it is asked for its user blocks (6.4).
enum class UserBlocks : std::uint8_t {
  dst,        ///< 264 bytes, and its FPGA data behind them
  dst_alone,  ///< 264 bytes, for clients that read those alone
  older,      ///< 175 bytes, of a head that is no DST
};

/// Section numbers are those of docs/protocols/micron.md. Most of these are choices in which drivers or heads
/// differ; the defaults suit most drivers, docs/your-micron-driver.md lists the others. The Device
/// constructor refuses what is out of range.
struct DeviceConfig {
  std::uint8_t node = default_head_node;  ///< 1..254 (2.1)
  bool half_duplex = false;               ///< one line for a request instead of two (8.1)
  VersionData version;                    ///< what it calls itself; its node is the one above (6.1)
  UserBlocks user_blocks = UserBlocks::dst;

  /// True speed of sound at the head, which makes ranges out of times. > 0 (4)
  double water_sound_speed_mps = 1500.0;
  bool mounted_inverted = false;  ///< boot down; right only if the host sets the invert bit (7.6)

  std::chrono::nanoseconds boot_time{700'000'000};  ///< deaf and dumb; >= 0, < 1 s (7.1)
  /// Least time of centring, even for a head at its centre; 0..15 s. The default is longer than one
  /// alive_period, for drivers that want two alives of it, and ends in time for those with a watchdog (7.4).
  std::chrono::nanoseconds least_centring_time{1'200'000'000};
  double seek_speed_rad_s = 1.5707963267948966;          ///< while centring, > 0 (7.4)
  std::chrono::nanoseconds alive_period{1'000'000'000};  ///< > 0 (7.1)
  bool alive_while_scanning = true;                      ///< also while lines are owed (8.5)
  bool alive_after_head_command = true;  ///< one answers it at once, beside the regular ones (7.1)
  bool direction_bit_kept = false;       ///< the alive tells "off centre" after centring, too (6.2)
  bool clock_follows_host = true;        ///< SendData with a time sets the clock (7.5)

  NibbleOrder nibble_order = NibbleOrder::high_first;  ///< of 4-bit data (6.3)
  LimitsOrder limits_order = LimitsOrder::clockwise;   ///< (8.3)
  bool always_reports_scan_right = false;              ///< whatever the direction (8.3)
  int request_cap = 2;                                 ///< requests remembered, 1..100 (8.2)
  bool requests_survive_head_command = true;           ///< (8.2)

  std::chrono::nanoseconds reconfiguration_time{
      250'000'000};                                        ///< from parameters to the first ping, >= 0 (8.4)
  std::chrono::nanoseconds reposition_limit{800'000'000};  ///< of that and the way to a sector, >= 0 (8.4)

  std::uint32_t baud = 115'200;                       ///< of the link, for the pace of lines; > 0 (8.4)
  std::chrono::nanoseconds line_overhead{3'000'000};  ///< beside listening, turning and sending, >= 0 (8.4)
  /// Time between lines instead of the one that follows from parameters and link; 0: as fast as they are
  /// rendered. >= 0
  std::optional<std::chrono::nanoseconds> line_period;

  /// The head sends the lines that it is fed (PingFed), and no others.
  bool plays_back = false;
  /// A ping begins when it is granted (PingGranted), as soon as one is owed, and its line leaves when it is
  /// there: the grant comes by NextPing. For pings that follow a simulated time.
  bool waits_for_permission = false;
};

}  // namespace sonard::micron
