// The Gemini 720i as a pure state machine: datagrams and time go in; datagrams and ping jobs come out.
// It knows no sockets, clocks, threads or images beyond sample bytes. Sources: docs/protocols/gemini.md.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// Time on any monotonic clock of the caller's choice; only differences matter.
using TimePoint = std::chrono::nanoseconds;

/// IPv4 address, first octet most significant (10.61.19.200 = 0x0A3D13C8).
using Ipv4 = std::uint32_t;

/// Everything a user may set about a head.
struct DeviceConfig {
  std::uint16_t sonar_id = 513;  ///< >= 2
  Ipv4 fixed_address = 0x0A3D13C8;
  Ipv4 alternate_address = 0;    ///< must be reachable by the client and non-zero
  Ipv4 netmask = 0xFFFFFF00;     ///< the real mask of the interface served
  std::array<std::uint8_t, 6> mac{0x00, 0x12, 0x34, 0x00, 0x02, 0x01};
  bool accept_id_zero = false;   ///< also take commands with header ID 0
  /// Out of the water the head does not ping unless told to; the server keeps this up to date.
  double water_sound_speed_mps = 0.0;  ///< 0: the water has the speed of the ping configuration
  std::chrono::nanoseconds status_period{std::chrono::seconds{1}};
  std::chrono::nanoseconds min_ping_period{33'300'000};
  std::chrono::nanoseconds surface_timeout{std::chrono::seconds{3}};
  std::chrono::nanoseconds reboot_time{std::chrono::seconds{5}};
  std::chrono::nanoseconds line_period{27'000};  ///< pacing between lines on the wire
  int burst_lines = 32;                          ///< most lines sent back to back
  std::chrono::nanoseconds retry_hold{10'000'000};      ///< new head waits this long after the last retry
  std::chrono::nanoseconds retry_hold_max{50'000'000};  ///< but never longer than this
};

/// One ping to be rendered, in SI units. The server maps it to renderer settings.
struct PingJob {
  std::uint64_t ping_number = 0;   ///< 0, 1, 2, ... since boot; the wire carries it modulo 256
  TimePoint transmit_time{};       ///< when the pulse leaves
  int native_lines = 0;            ///< range lines before compression
  double line_step_m = 0.0;        ///< c_w / (2 * 90422 Hz)
  int compression_log2 = 0;        ///< 0..4, average
  bool sixteen_bit = false;
  bool transmit = true;            ///< false: txLength 0, the head only listens
  double gain_db = 0.0;            ///< relative to 50 % percent gain and nominal main gain
  double sound_speed_mps = 0.0;
};

/// The rendered samples of a job, line after line, port to starboard. Exactly one of u8/u16 is filled.
struct PingImage {
  std::uint64_t ping_number = 0;
  std::vector<std::uint8_t> u8;
  std::vector<std::uint16_t> u16;
};

/// A datagram to send now.
struct Outgoing {
  enum class To { status, surface } to = To::surface;  ///< `status`: wherever status packets go (broadcast, unicast list)
  Ipv4 surface = 0;                                    ///< destination for To::surface; the port is always 52900
  Ipv4 reply_from = 0;                                 ///< address on which the surface addressed the head; 0 = any
  std::vector<std::uint8_t> bytes;
};

/// Counters for logs and metrics. They only grow.
struct DeviceCounters {
  std::uint64_t pings_started = 0, pings_sent = 0, lines_sent = 0, lines_resent = 0, tails_resent = 0,
                heads_resent = 0, retries_received = 0, retries_dropped = 0, commands = 0, bad_datagrams = 0,
                wrong_id = 0, unknown_type = 0, unsupported_data = 0, pings_suppressed = 0, surface_changes = 0,
                surface_timeouts = 0, reboots = 0, stale_images = 0;
};

/// Not thread-safe: one thread calls everything. `now` never goes backwards.
class Device {
 public:
  Device(const DeviceConfig& config, TimePoint boot_time);

  /// A datagram that arrived on port 52901. Bad ones are counted and dropped.
  void on_datagram(TimePoint now, Ipv4 from, Ipv4 to, std::span<const std::uint8_t> bytes);
  /// The image of the job taken last. An image of any other job is counted and dropped.
  void on_image(TimePoint now, PingImage image);
  /// The job taken last cannot be rendered (stale pose under policy `silence`): the head goes on without this ping.
  void on_image_failed(TimePoint now, std::uint64_t ping_number);
  /// Tells the head whether it is out of the water, and the true speed of sound there.
  void set_environment(bool out_of_water);
  /// One external TTL trigger edge (run mode 2).
  void on_trigger(TimePoint now);

  /// Runs everything due at `now`. Call after every on_*() and at next_deadline().
  void advance(TimePoint now);
  /// When advance() is next needed; nullopt: only after an event.
  std::optional<TimePoint> next_deadline() const;

  /// Datagrams due by the last advance(), in order. Each call empties the list.
  std::vector<Outgoing> take_outgoing();
  /// A ping to render, at most one outstanding. Each call empties it.
  std::optional<PingJob> take_job();

  const DeviceCounters& counters() const;
  Ipv4 surface() const;  ///< 0 when no surface is connected
};

}  // namespace sonard::gemini
