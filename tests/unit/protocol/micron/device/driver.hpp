// SPDX-License-Identifier: Apache-2.0
// A driver's end of the line, with blocking calls in virtual time.
#pragma once

#include <random>

#include "bench.hpp"

namespace sonard::micron {

struct Link {
  const char* name;
  bool split = false;  ///< every write arrives in two pieces, 5 ms apart
  bool noise = false;  ///< random bytes before every write, with many '@' and line feeds among them
  bool half_duplex = false;
  bool freshly_powered = false;  ///< the driver starts together with the head, not long after it
};

/// The link of a driver that starts together with the daemon.
inline constexpr Link fresh{.name = "fresh", .freshly_powered = true};

inline void PrintTo(const Link& link, std::ostream* out) {
  *out << link.name;
}

/// A driver's end of the line, with blocking calls.
class Driver {
 public:
  explicit Driver(const Link& link, const DeviceConfig& config = {})
      : link_(link), bench_(on_link(config, link)) {
    bench_.render_time = 5ms;
    if (!link.freshly_powered) {
      bench_.run_until(20'300ms);
    }
    read_ = bench_.sent.size();
  }

  Bench& bench() { return bench_; }

  void write(const Bytes& bytes) {
    if (link_.noise) {
      Bytes noise(random_() % 12);
      std::ranges::generate(noise, [&] {
        const std::uint8_t likely[] = {'@', 0x0A, '0', static_cast<std::uint8_t>(random_())};
        return likely[random_() % 4];
      });
      bench_.raw(noise);
    }
    if (link_.split) {
      const std::size_t half = 1 + random_() % (bytes.size() - 1);
      bench_.raw(std::span{bytes}.first(half));
      bench_.run_for(5ms);
      bench_.raw(std::span{bytes}.subspan(half));
    } else {
      bench_.raw(bytes);
    }
  }
  void write(const std::string& name) { write(fixture(name)); }
  void sleep(std::chrono::nanoseconds time) { bench_.run_for(time); }
  void flush() { read_ = bench_.sent.size(); }

  /// The next frame of any type; nullopt after `timeout`.
  std::optional<Bytes> read(std::chrono::nanoseconds timeout) {
    const TimePoint end = bench_.now + timeout;
    while (read_ == bench_.sent.size()) {
      if (bench_.next_event() > end) {
        bench_.run_until(end);
        return std::nullopt;
      }
      bench_.run_once();
    }
    return bench_.sent[read_++].bytes;
  }
  /// The next frame of a type that meets a condition; other frames are skipped. nullopt after `timeout`.
  std::optional<Bytes> await(
      MessageType type, std::chrono::nanoseconds timeout,
      const std::function<bool(const Bytes&)>& meets = [](const Bytes&) { return true; }) {
    for (const TimePoint end = bench_.now + timeout; bench_.now < end;) {
      const auto frame = read(end - bench_.now);
      if (frame && (*frame)[10] == static_cast<std::uint8_t>(type) && meets(*frame)) {
        return frame;
      }
    }
    return std::nullopt;
  }
  /// The next alive whose HeadInf has all bits of `set` set and all bits of `clear` clear.
  std::optional<Bytes> await_alive(int set, int clear, std::chrono::nanoseconds timeout) {
    return await(MessageType::alive, timeout,
                 [&](const Bytes& alive) { return (alive[20] & set) == set && (alive[20] & clear) == 0; });
  }
  std::optional<Bytes> await_line(std::chrono::nanoseconds timeout) {
    return await(MessageType::head_data, timeout);
  }

 private:
  static DeviceConfig on_link(DeviceConfig config, const Link& link) {
    config.half_duplex = config.half_duplex || link.half_duplex;
    return config;
  }

  Link link_;
  Bench bench_;
  std::size_t read_ = 0;
  std::mt19937 random_{7};
};

inline int bearing_of(const Bytes& line) {
  return line[40] | line[41] << 8;
}

}  // namespace sonard::micron
