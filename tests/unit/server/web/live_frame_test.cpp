// SPDX-License-Identifier: Apache-2.0
// Pings in the format for viewers. The expected samples were calculated by hand from the layout in
// docs/page.md.
#include "server/web/live_frame.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace sonard::server {
namespace {

struct Decoded {
  nlohmann::json header;
  std::vector<float> bearings_rad;
  std::vector<int> samples;
};

Decoded decoded(const std::string& frame, std::size_t bearings) {
  std::uint32_t length = 0;
  std::memcpy(&length, frame.data(), 4);
  EXPECT_EQ(length % 4, 0U);
  Decoded result{nlohmann::json::parse(frame.substr(4, length)), std::vector<float>(bearings), {}};
  std::memcpy(result.bearings_rad.data(), &frame.at(4 + length), 4 * bearings);
  for (std::size_t i = 4 + length + 4 * bearings; i < frame.size(); ++i) {
    result.samples.push_back(static_cast<unsigned char>(frame[i]));
  }
  return result;
}

std::shared_ptr<const ShownPing> ping(int beams, int bins, std::vector<std::uint8_t> samples,
                                      std::vector<double> bearings_rad) {
  auto shown = std::make_shared<ShownPing>();
  shown->head = 3;
  shown->record.number = 17;
  shown->record.settings.beams = beams;
  shown->record.settings.bins = bins;
  shown->record.settings.bin_m = 0.5;
  shown->record.samples = std::move(samples);
  shown->record.bearings_rad = std::move(bearings_rad);
  return shown;
}

TEST(LiveFrame, ShowsAmplitudesWhereSamplesAreTheirSquareRoots) {
  auto roots = std::make_shared<ShownPing>(*ping(2, 2, {0, 16, 128, 255}, {-0.25, 0.25}));
  roots->record.settings.amplitude_exponent = 0.5;
  const std::array<std::shared_ptr<const ShownPing>, 1> pings{roots};
  EXPECT_EQ(decoded(live_frame(pings, 600, {}), 2).samples, (std::vector<int>{0, 1, 64, 255}));
}

TEST(LiveFrame, CarriesAFanRowByRow) {
  const Decoded frame =
      decoded(live_frame(std::array{ping(2, 3, {1, 2, 3, 4, 5, 255}, {-0.25, 0.25})}, 600, {}), 2);
  EXPECT_EQ(frame.header["head"], 3);
  EXPECT_EQ(frame.header["number"], 17);
  EXPECT_EQ(frame.header["rows"], 3);
  EXPECT_EQ(frame.header["bin_m"], 0.5);
  EXPECT_EQ(frame.header["range_m"], 1.5);
  EXPECT_EQ(frame.header["pose"], nullptr);
  EXPECT_EQ(frame.bearings_rad, (std::vector<float>{0.25F, -0.25F}));
  EXPECT_EQ(frame.samples, (std::vector<int>{1, 2, 3, 4, 5, 255}));
}

TEST(LiveFrame, SaysHowOldItsPingIs) {
  auto old = std::make_shared<ShownPing>(*ping(1, 1, {9}, {0.0}));
  old->time = std::chrono::seconds{100};
  const std::array<std::shared_ptr<const ShownPing>, 1> pings{old};
  EXPECT_EQ(decoded(live_frame(pings, 600, std::chrono::milliseconds{175'500}), 1).header["age_s"], 75.5);
}

TEST(LiveFrame, ShowsTheLargestOfRowsThatBecomeOne) {
  // Five rows with a limit of three: pairs are joined, and the last row is alone. 200 must not become
  // negative.
  const Decoded frame =
      decoded(live_frame(std::array{ping(2, 5, {1, 9, 200, 2, 3, 3, 4, 1, 7, 8}, {0, 1})}, 3, {}), 2);
  EXPECT_EQ(frame.header["rows"], 3);
  EXPECT_EQ(frame.header["bin_m"], 1.0);
  EXPECT_EQ(frame.header["range_m"], 2.5);
  EXPECT_EQ(frame.samples, (std::vector<int>{200, 9, 4, 3, 7, 8}));
}

TEST(LiveFrame, CarriesLinesOfAScanningHeadOneAfterTheOther) {
  const Decoded frame =
      decoded(live_frame(std::array{ping(1, 2, {1, 2}, {0.5}), ping(1, 2, {3, 4}, {0.75})}, 600, {}), 2);
  EXPECT_EQ(frame.header["lines"], 2);
  EXPECT_EQ(frame.header["scanning"], true);
  EXPECT_EQ(frame.bearings_rad, (std::vector<float>{-0.5F, -0.75F}));
  EXPECT_EQ(frame.samples, (std::vector<int>{1, 2, 3, 4}));
}

}  // namespace
}  // namespace sonard::server
