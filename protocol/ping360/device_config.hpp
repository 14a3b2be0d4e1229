// SPDX-License-Identifier: Apache-2.0
// Everything a user may set about a simulated Ping360, as plain values.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "protocol/ping360/frame.hpp"
#include "protocol/ping360/messages.hpp"

namespace sonard::ping360 {

/// Who gets what the head says (4.2).
enum class FanOut : std::uint8_t {
  requester,  ///< who has asked for it, or has started the scan
  all,        ///< every client, as behind the bridge of a vehicle
};

/// Section numbers are those of docs/protocols/ping360.md. The Device constructor refuses what is out of
/// range.
struct DeviceConfig {
  std::uint8_t id = default_device_id;  ///< 1..254, until a client sets another (1, 3.6)
  DeviceInformation information;        ///< what it calls itself; its revision is not 0 (2.1)

  /// True speed of sound at the head, which makes ranges out of times; > 0 (2.3).
  double water_sound_speed_mps = 1500.0;
  std::array<double, 3> gain_db{0.0, 6.0, 12.0};  ///< of the gain settings low, normal and high (2.3)
  int bearing_offset = 0;                         ///< gradians at which the head looks straight ahead (6)

  std::chrono::nanoseconds ping_overhead{18'000'000};    ///< beside listening and turning, >= 0 (3.7)
  std::chrono::nanoseconds time_per_gradian{6'100'000};  ///< of turning, >= 0 (3.7)
  /// Factor on all of its times from ping to ping, >= 0; 0: it is as fast as pings are rendered (3.7).
  double time_scale = 1.0;

  /// A client that is silent for so long is forgotten, and the scan ends that it has begun; 0: never, as a
  /// real head, since clients may listen for a whole turn of 38 s without a word. Clients on a serial line
  /// are never forgotten. (3.3)
  std::chrono::nanoseconds idle_timeout{0};
  std::chrono::nanoseconds reset_silence{std::chrono::seconds{1}};       ///< >= 0 (3.5)
  std::chrono::nanoseconds bootloader_silence{std::chrono::seconds{5}};  ///< >= 0 (3.5)

  /// A transducer command that repeats the client's last unanswered one shares its answer (3.2).
  bool joins_repeated_commands = true;
  /// Commands that wait for the one that is being done; 0: what comes meanwhile is dropped (3.2).
  std::size_t queue_length = 4;
  bool accepts_angle_400 = true;            ///< as angle 0 (2.3)
  bool obeys_set_common_device_id = false;  ///< message 100 as 2000 (3.6)
  bool signed_scan_angles = false;          ///< limits of a scan may be below 0: never refused (2.3)
  bool clamps_scan_to_stop = false;         ///< a sector ends at its limit, not at the last whole step (3.3)
  bool ignores_other_destinations = false;  ///< what is neither for its id nor for 0 or 255 (1)

  FanOut fan_out = FanOut::requester;
  std::size_t max_clients =
      32;  ///< told apart; beyond that the one that was silent longest is forgotten; >= 2
  /// Bytes of a datagram; longer frames are split. 0: one frame, one datagram (4.1).
  std::size_t max_datagram = 0;
  /// Of the first address that sends a command, until it is silent for `idle_timeout`, which then is > 0;
  /// what others send is dropped (docs/security.md).
  bool lock_to_first = false;
  int serial_channel = -1;  ///< the Peer::channel that is a serial line; -1: none (4.4)

  /// The head sends the pings that it is fed (PingFed), and no others.
  bool plays_back = false;
  /// A ping begins when it is granted (PingGranted), as soon as one is wanted, and leaves when it is there:
  /// whoever grants it keeps to NextPing. For pings that follow a simulated time.
  bool waits_for_permission = false;
};

}  // namespace sonard::ping360
