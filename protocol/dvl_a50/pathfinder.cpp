// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/pathfinder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "protocol/dvl_a50/utc.hpp"

namespace sonard::dvl_a50 {
namespace {

constexpr std::size_t pd4_bytes = 47;
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
  std::vector<std::uint8_t> bytes(pd4_bytes);
  const auto put = [&](std::size_t offset, int value) {
    bytes[offset] = static_cast<std::uint8_t>(value & 0xFF);
    bytes[offset + 1] = static_cast<std::uint8_t>(value >> 8 & 0xFF);
  };
  constexpr int bad = -32768;
  bytes[0] = 0x7D;
  put(2, pd4_bytes - 2);
  bytes[4] = 0xA3;  // ship coordinates, tilt used, 600 kHz
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(5 + 2 * axis, report.valid ? millimetres(report.velocity_mps[axis]) : bad);
  }
  put(11, report.valid ? 0 : bad);  // the error velocity
  for (std::size_t i = 0; i < pd4_beams.size(); ++i) {
    const double distance_m = report.valid ? std::max(0.0, report.beams[pd4_beams[i]].distance_m) : 0.0;
    put(13 + 2 * i, static_cast<int>(std::lround(std::min(1e2 * distance_m, 65'535.0))));
  }
  bytes[21] = report.valid ? 0 : 1;
  const Utc t = utc_of(report.validity_us);
  const std::array<int, 4> clock{t.hour, t.minute, t.second, t.microsecond / 10'000};
  std::ranges::copy(clock, bytes.begin() + 35);
  put(41, static_cast<int>(std::lround(sound_speed_mps)));
  int sum = 0;
  for (const std::uint8_t byte : bytes) {
    sum += byte;
  }
  put(pd4_bytes - 2, sum);
  return bytes;
}

}  // namespace sonard::dvl_a50
