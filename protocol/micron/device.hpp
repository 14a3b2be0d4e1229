// The Micron as a pure state machine: bytes and time go in; frames and ping jobs come out.
// It knows no sockets, serial ports, clocks or threads. Source: docs/protocols/micron.md.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/common/ping_wish.hpp"
#include "protocol/micron/device_config.hpp"
#include "protocol/micron/device_counters.hpp"
#include "protocol/micron/micron_job.hpp"

namespace sonard::micron {

enum class HeadState : std::uint8_t {
  booting,             ///< deaf and dumb
  centring,            ///< looks for its centre; takes parameters
  without_parameters,  ///< centred
  ready,
  scanning,  ///< lines are owed
};

/// "booting", "centring", "without_parameters", "ready", "scanning".
std::string_view to_string(HeadState state);

/// One head. Typical use, on one thread:
///   device.on_bytes(now, bytes);             // or on_line(), or a timer ran out
///   device.advance(now);
///   for (auto& frame : device.take_outgoing()) write(frame);
///   if (auto job = device.take_job()) render(*job);  // answer later with on_line() or on_line_failed()
///   wait_until(device.next_deadline());
///
/// A head runs on whether anybody listens or not: what it says while nobody is connected is the caller's to
/// throw away. Not thread-safe. `now` never goes backwards over all calls.
class Device {
 public:
  /// A head that was powered up in time: at `start` it is centred and has no parameters.
  /// @throws std::invalid_argument naming the field of `config` that is out of range
  Device(const DeviceConfig& config, TimePoint start);
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;

  /// Bytes from the host, cut as they happen to come. What is no frame is counted and dropped.
  void on_bytes(TimePoint now, std::span<const std::uint8_t> bytes);
  /// The host is gone: what it had begun to say will not be finished by the next one.
  void on_host_gone();
  /// The line of the job taken last. It is counted and dropped when that ping has been called off meanwhile.
  void on_line(TimePoint now, const MicronLine& line);
  /// The job taken last cannot be rendered (stale pose under policy `silence`): no line is sent for it.
  void on_line_failed(TimePoint now, std::uint64_t ping_number);

  /// Power fails and comes back: like a reboot that nobody asked for.
  void power_cycle(TimePoint now);
  /// The motor loses its step: lines say so until new parameters come.
  void lose_step();
  /// For DeviceConfig::plays_back: the line to send when the host next wants one, in place of the one offered
  /// before. Gone when its job is out; without one no ping begins.
  void offer(const std::optional<RecordedLine>& line);

  /// For DeviceConfig::waits_for_permission: the ping that it would begin next; nullopt: none.
  std::optional<PingWish> ping_wish() const;
  /// That ping begins with the next advance(), which is not before PingWish::from.
  void permit_ping();

  /// Runs everything due at `now`. Call after every on_*() and at next_deadline().
  void advance(TimePoint now);
  /// When advance() is next needed; always later than the last advance(). nullopt: only after an event.
  std::optional<TimePoint> next_deadline() const;

  /// Frames due by the last advance(), in order: one whole frame each, to be written in one go. Each call
  /// empties the list.
  std::vector<std::vector<std::uint8_t>> take_outgoing();
  /// A ping to render. Each call empties it. Every job taken must be answered once, by on_line() or
  /// on_line_failed(): the next job waits for that, so at most one is outstanding.
  std::optional<MicronJob> take_job();
  /// The line that has left since the last call. Call it after each advance(), which sends one at most.
  std::optional<SentLine> take_sent_line();
  /// The ping whose job is out though nobody wants its line any more: new parameters, reboot. It must still
  /// be answered; on_line_failed() without rendering it will do. nullopt: there is none.
  std::optional<std::uint64_t> called_off() const;

  const DeviceCounters& counters() const;
  HeadState state(TimePoint now) const;
  /// What the host has told it last; nullopt: nothing since power came on.
  const std::optional<HeadCommand>& parameters() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::micron
