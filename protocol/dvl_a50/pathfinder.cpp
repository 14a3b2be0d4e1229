// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/pathfinder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "protocol/dvl_a50/layout.hpp"
#include "protocol/dvl_a50/utc.hpp"

namespace sonard::dvl_a50 {
namespace {

constexpr std::int16_t bad_velocity = -32768;
constexpr std::array<std::size_t, 4> pd4_beams{2, 0, 3, 1};  ///< ids, in the order of BM1 to BM4

int millimetres(double metres) {
  return static_cast<int>(std::lround(std::clamp(1e3 * metres, -32767.0, 32767.0)));
}

}  // namespace

std::string encode_pd6(const Velocity& report, double sound_speed_mps, Release release) {
  const bool newer = release >= Release::v2_6_1;
  const Utc t = utc_of(newer ? report.validity_us : report.transmission_us);
  const int x = millimetres(report.velocity_mps[0]), y = millimetres(report.velocity_mps[1]),
            z = millimetres(report.velocity_mps[2]);
  const char good = report.valid ? 'A' : 'V';
  return fmt::format(
      ":SA, +0.00, +0.00,  0.00\r\n"
      ":TS,{:02}{:02}{:02}{:02}{:02}{:02}{:02}, 0.0, +0.0,   0.0,{:6.1f},  0\r\n"
      ":WI,    +0,    +0,    +0,    +0,V\r\n"
      ":WS,    +0,    +0,    +0,V\r\n"
      ":WE,    +0,    +0,    +0,V\r\n"
      ":WD,       +0.00,       +0.00,       +0.00,   0.00,  0.00\r\n"
      ":BI,{:>+6},{:>+6},{:>+6},    +0,{}\r\n"
      ":BS,{:>+6},{:>+6},{:>+6},{}\r\n"
      ":BE,    +0,    +0,    +0,V\r\n"
      ":BD,       +0.00,       +0.00,       +0.00,{:7.2f},  0.00\r\n",
      t.year % 100, t.month, t.day, t.hour, t.minute, t.second, t.microsecond / 10'000,
      newer ? sound_speed_mps : 1475.0, x, y, z, good, newer ? y : 0, newer ? x : 0, newer ? z : 0, good,
      std::max(0.0, report.altitude_m));
}

std::vector<std::uint8_t> encode_pd4(const Velocity& report, double sound_speed_mps) {
  Pd4 packet;
  packet.velocity_mmps.fill(bad_velocity);
  packet.bottom_status = report.valid ? 0 : 1;
  for (std::size_t axis = 0; axis < 3 && report.valid; ++axis) {
    packet.velocity_mmps[axis] = static_cast<std::int16_t>(millimetres(report.velocity_mps[axis]));
    packet.velocity_mmps[3] = 0;
  }
  for (std::size_t i = 0; i < pd4_beams.size() && report.valid; ++i) {
    const double distance_cm = 1e2 * report.beams[pd4_beams[i]].distance_m;
    packet.range_cm[i] = static_cast<std::uint16_t>(std::lround(std::clamp(distance_cm, 0.0, 65'535.0)));
  }
  const Utc t = utc_of(report.validity_us);
  const std::array<int, 4> clock{t.hour, t.minute, t.second, t.microsecond / 10'000};
  std::ranges::copy(clock, packet.clock.begin());
  packet.sound_speed_mps = static_cast<std::uint16_t>(std::lround(sound_speed_mps));

  const auto bytes_of = [&packet] {
    std::vector<std::uint8_t> bytes;
    ByteWriter writer(bytes);
    write_fields<Pd4Layout>(writer, packet);
    return bytes;
  };
  const std::vector<std::uint8_t> summed = bytes_of();  // with a checksum of 0
  packet.checksum = static_cast<std::uint16_t>(std::accumulate(summed.begin(), summed.end(), 0));
  return bytes_of();
}

}  // namespace sonard::dvl_a50
