// The Gemini 720i as a pure state machine: datagrams and time go in; datagrams and ping jobs come out.
// It knows no sockets, clocks, threads or images beyond sample bytes. Source: docs/protocols/gemini.md.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_wish.hpp"
#include "protocol/gemini/device_config.hpp"
#include "protocol/gemini/device_counters.hpp"
#include "protocol/gemini/encoded_ping.hpp"
#include "protocol/gemini/ping_job.hpp"
#include "protocol/gemini/shared_bytes.hpp"

namespace sonard::gemini {

/// A datagram to send now.
struct Outgoing {
  enum class To {
    status,   ///< wherever status packets go: broadcast or a list of hosts
    surface,  ///< the surface named below
  };
  To to = To::surface;
  Ipv4 surface = 0;     ///< destination for To::surface; the port is always 52900
  Ipv4 reply_from = 0;  ///< address on which the surface addressed the head; 0 = any
  SharedBytes bytes;
};

/// The addresses a head answers on, and the mask it reports.
struct DeviceAddresses {
  Ipv4 fixed = 0;
  Ipv4 alternate = 0;
  Ipv4 netmask = 0;

  bool operator==(const DeviceAddresses&) const = default;
};

/// One head. Typical use, on one thread:
///   device.on_datagram(now, from, to, bytes);      // or on_image(), on_trigger(), or a timer ran out
///   device.advance(now);
///   send(device.take_outgoing());
///   if (auto job = device.take_job()) render(*job);  // answer later with on_image() or on_image_failed()
///   wait_until(device.next_deadline());
///
/// Not thread-safe. `now` never goes backwards over all calls.
class Device {
 public:
  /// Boots at `boot_time`: the clock of the head is 0 then, and the first status is due.
  /// @throws std::invalid_argument naming the field of `config` that is out of range
  Device(const DeviceConfig& config, TimePoint boot_time);
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;

  /// A datagram that arrived on port 52901, from the address `from`, sent to our address `to` (0: unknown).
  /// Bad ones are counted and dropped.
  void on_datagram(TimePoint now, Ipv4 from, Ipv4 to, std::span<const std::uint8_t> bytes);
  /// The image of the job taken last. It is counted and dropped when that ping has been called off meanwhile.
  void on_image(TimePoint now, const PingImage& image);
  /// The job taken last cannot be rendered (stale pose under policy `silence`): the head goes on without this
  /// ping.
  void on_image_failed(TimePoint now, std::uint64_t ping_number);
  /// Out of the water the head does not ping unless the configuration says so, and reports it in its status.
  void set_out_of_water(bool out_of_water);
  /// One edge at the external trigger input (run mode 2).
  void on_trigger(TimePoint now);
  /// For DeviceConfig::plays_back: the ping to send when the surface next wants one, in place of the one
  /// offered before. Gone when its job is out; without one no ping begins.
  void offer(const std::optional<RecordedPing>& ping);
  /// For DeviceConfig::waits_for_permission: the ping that it would begin next; nullopt: none.
  std::optional<PingWish> ping_wish() const;
  /// That ping begins with the next advance(), which is not before PingWish::from.
  void permit_ping();

  /// Runs everything due at `now`. Call after every on_*() and at next_deadline(). Calls that come late are
  /// made up for within the pacing rules: no more than DeviceConfig::burst_lines ping datagrams leave at
  /// once.
  void advance(TimePoint now);
  /// When advance() is next needed; always later than the last advance(). nullopt: only after an event.
  std::optional<TimePoint> next_deadline() const;

  /// Datagrams due by the last advance(), in order. Each call empties the list.
  std::vector<Outgoing> take_outgoing();
  /// A ping to render. Each call empties it. Every job taken must be answered once, by on_image() or
  /// on_image_failed(): the next job waits for that, so at most one is outstanding.
  std::optional<PingJob> take_job();
  /// The ping that has gone onto the wire since the last call: its head is among the datagrams, or about to
  /// be. Call it after each advance(), which begins one at most.
  std::optional<ServedPing> take_served();
  /// The ping whose job is out though nobody wants its image any more: surface gone, reboot, new settings. It
  /// must still be answered; on_image_failed() without rendering it will do. nullopt: there is none.
  std::optional<std::uint64_t> called_off() const;

  const DeviceCounters& counters() const;
  /// The connected surface; 0 when none is.
  Ipv4 surface() const;
  /// What the head answers on. Changes when a reboot applies an address that a client has programmed
  /// (3.7, 3.9); the server then moves its sockets while the head is still silent.
  DeviceAddresses addresses() const;
  /// Microseconds of the head's clock at `now`; 0 while it reboots.
  std::uint64_t clock_us(TimePoint now) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::gemini
