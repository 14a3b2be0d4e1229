// SPDX-License-Identifier: Apache-2.0
// The serial line: commands, their answers, and the sentences of each output.
#include "protocol/dvl_a50/sentences.hpp"
#include "tests/unit/protocol/dvl_a50/device/bench.hpp"

namespace sonard::dvl_a50 {
namespace {

int count(const std::string& text, const std::string& word) {
  int found = 0;
  for (std::size_t place = 0; (place = text.find(word, place)) != std::string::npos; ++place) {
    ++found;
  }
  return found;
}

TEST(DvlSerial, AnswersHaveTheirChecksums) {
  Bench bench(quiet(true));
  EXPECT_EQ(bench.serial("wcv*fe"), "wrv,2.8.0*b2\r\n");
  EXPECT_EQ(bench.serial("wcv"), "wrv,2.8.0*b2\r\n");
  EXPECT_EQ(bench.serial("wcc*95"), "wrc,1475,0,y,n,auto,y*7e\r\n");
  EXPECT_EQ(bench.serial("wcr*e2"), "wra*d9\r\n");
  EXPECT_EQ(bench.serial("wcv*00"), "wr!*1e\r\n");
  EXPECT_EQ(bench.serial("hello"), "wr?*44\r\n");
  EXPECT_EQ(bench.serial("wcx"), "wrn*f4\r\n") << "acoustics are on";
  EXPECT_TRUE(bench.serial("wcw").starts_with("wrw,dvl-a50,2.7.2,0x"));
  EXPECT_EQ(bench.serial("wct").substr(0, 18), "wrs,1767225600,0,,");
  EXPECT_EQ(bench.serial("wcN"), with_checksum("wrN,auto") + "\r\n");
  EXPECT_EQ(bench.serial("wcn,10.0.0.1"), "wra*d9\r\n");
  EXPECT_EQ(bench.serial("wcN"), with_checksum("wrN,10.0.0.1") + "\r\n");
  EXPECT_EQ(bench.serial("wcm,1000000"), "wra*d9\r\n");
  EXPECT_EQ(bench.serial("wct"), with_checksum("wrs,1,0,,") + "\r\n");
}

TEST(DvlSerial, SettingsAreThoseOfAllClients) {
  Bench bench(quiet(true));
  EXPECT_EQ(bench.serial("wcs,1450,,n,,,*c5"), "wra*d9\r\n");
  EXPECT_EQ(*bench.ask("get_config").result.find("speed_of_sound")->as<double>(), 1450.0);
  EXPECT_EQ(bench.serial("wcs,,,,y,,*35"), "wra*d9\r\n");
  EXPECT_EQ(bench.serial("wcs,,45,y,n"), "wra*d9\r\n") << "the last two may be missing";
  EXPECT_EQ(bench.serial("wcc"), with_checksum("wrc,1450,45,y,n,auto,y") + "\r\n");
  EXPECT_EQ(bench.serial("wcs,2500,,,,,"), "wrn*f4\r\n") << "out of range";
  EXPECT_EQ(bench.serial("wcs,fast,,,,,"), "wr?*44\r\n");
  EXPECT_EQ(bench.serial("wcs,1450"), "wr?*44\r\n") << "too few options";
}

TEST(DvlSerial, LinesMayEndInThreeWaysAndMustEnd) {
  Bench bench(quiet(true));
  std::string& heard = bench.heard[std::pair(4, std::uint16_t{0})];
  heard.clear();
  bench.say("wcv\rwcv\r\nwc", serial_client);
  EXPECT_EQ(heard, "wrv,2.8.0*b2\r\nwrv,2.8.0*b2\r\n");
  bench.say("v\n", serial_client);
  EXPECT_EQ(count(heard, "wrv"), 3);
  bench.say("wcv", serial_client);
  EXPECT_EQ(count(heard, "wr?"), 0);
  bench.run_for(20ms);
  EXPECT_EQ(count(heard, "wr?*44"), 1) << "the patience is at its end";
}

TEST(DvlSerial, EachOutputHasItsSentences) {
  const auto output = [](const std::string& number) {
    Bench bench(quiet(true));
    bench.run_for(1s);
    EXPECT_EQ(bench.serial("wcp," + number), "wra*d9\r\n");
    bench.heard[std::pair(4, std::uint16_t{0})].clear();
    bench.velocities.clear();
    bench.run_for(5s);
    return std::pair(bench.heard[std::pair(4, std::uint16_t{0})], static_cast<int>(bench.velocities.size()));
  };
  const auto [all, pings] = output("1");
  EXPECT_EQ(count(all, "wrz,"), pings);
  EXPECT_EQ(count(all, "wru,"), 4 * pings);
  EXPECT_EQ(count(all, "wrx,"), pings);
  EXPECT_EQ(count(all, "wrt,"), pings);
  EXPECT_EQ(count(all, "wrp,"), 25);
  const auto newer = output("3").first;
  EXPECT_EQ(count(newer, "wrz,"), pings);
  EXPECT_EQ(count(newer, "wrx,") + count(newer, "wrt,"), 0);
  EXPECT_EQ(count(output("2").first, ":BI,"), pings);
  EXPECT_EQ(output("6").first.size(), 47U * static_cast<std::size_t>(pings));
  EXPECT_EQ(output("0").first, "");
  Bench bench(quiet(true));
  EXPECT_EQ(bench.serial("wcp,4"), "wr?*44\r\n");
}

TEST(DvlSerial, ADeviceWithASerialLinePingsWithoutAClient) {
  Bench bench(quiet(true));
  bench.step(ClientGone{client_a});
  const std::size_t before = bench.jobs.size();
  bench.run_for(2s);
  EXPECT_GT(bench.jobs.size(), before);
}

}  // namespace
}  // namespace sonard::dvl_a50
