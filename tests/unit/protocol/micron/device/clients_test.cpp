// SPDX-License-Identifier: Apache-2.0
// The start-up and scan of each family of drivers, with its own bytes, conditions and timeouts
// (protocol/micron/README.md 9), over clean and over poor lines.
#include "driver.hpp"

namespace sonard::micron {
namespace {

class Clients : public ::testing::TestWithParam<Link> {};

/// 9.1. An alive counts as "configured" if it has "in centre" and not "centred". The driver reads the first
/// alive after its reboot and sends its parameters. It reads more alives only until one counts. One more
/// alive must then count, or it gives up. A reconfiguration may send parameters before that alive.
void ros_begin(Driver& driver, bool stale_alive, bool reconfigures) {
  const auto configured = [](const Bytes& alive) { return (alive[20] & 0x03) == 0x01; };
  driver.write("reboot");
  if (stale_alive) {  // an alive from before the reboot does not count, and the parameters are lost
    driver.write("head_command_ros");
  }
  auto alive = driver.await(MessageType::alive, 2s);
  ASSERT_TRUE(alive);
  if (!stale_alive) {
    driver.write("head_command_ros");
  }
  while (!configured(*alive)) {
    alive = driver.await(MessageType::alive, 2s);
    ASSERT_TRUE(alive);
  }
  if (reconfigures) {
    driver.write("head_command_ros");
  }
  alive = driver.await(MessageType::alive, 2s);
  ASSERT_TRUE(alive);
  ASSERT_TRUE(configured(*alive)) << "or it gives up: not configured";
  ASSERT_TRUE((*alive)[20] & 0x08);
}

// One start in a hundred takes an alive from before the reboot for an answer to it. Then its parameters are
// lost, and it needs two alives of the centring head. It also needs two if no alive answers its parameters.
TEST(Clients, RosGetsTwoAlivesOfACentringHead) {
  for (const bool alive_after_head_command : {false, true}) {
    for (const bool stale_alive : {false, true}) {
      for (const bool reconfigures : {false, true}) {
        DeviceConfig config;
        config.alive_after_head_command = alive_after_head_command;
        Driver driver({"clean"}, config);
        ASSERT_NO_FATAL_FAILURE(ros_begin(driver, stale_alive, reconfigures));
      }
    }
  }
}

TEST_P(Clients, Ros) {
  {
    Driver driver(GetParam());
    ASSERT_NO_FATAL_FAILURE(ros_begin(driver, /*stale_alive=*/false, /*reconfigures=*/true));
  }
  Driver driver(GetParam());
  ASSERT_NO_FATAL_FAILURE(ros_begin(driver, /*stale_alive=*/false, /*reconfigures=*/false));

  std::vector<int> bearings;
  for (int misses = 0; bearings.size() < 60;) {
    driver.write("send_data");
    // Its read has no timeout. It checks whether a second has passed only when a frame arrives.
    const TimePoint asked = driver.bench().now;
    std::optional<Bytes> frame;
    do {
      frame = driver.read(3s);
      ASSERT_TRUE(frame) << "it would hang";
    } while ((*frame)[10] != 2 && driver.bench().now - asked < 1s);
    if ((*frame)[10] == 2) {
      bearings.push_back(bearing_of(*frame));
      EXPECT_EQ((*frame)[15], 0x11);
    } else {
      ASSERT_LT(++misses, 5) << "it would send its parameters again";
    }
  }
  for (std::size_t i = 0; i < bearings.size(); ++i) {
    EXPECT_EQ(bearings[i], 3200 + 32 * static_cast<int>(i));
  }
  driver.write("reboot");
}

/// The checks that the ROCK driver makes on every line.
void expect_echo(const Bytes& command, const Bytes& line) {
  EXPECT_EQ(line[16] & 0x02, 0);
  EXPECT_EQ(line[18] & 0x0B, command[14] & 0x0B);
  EXPECT_EQ((Bytes{line[35], line[36], line[37], line[38]}),
            (Bytes{command[37], command[38], command[39], command[40]}));
  EXPECT_EQ(line[39], command[50]);
  EXPECT_EQ(line[29], command[41]);
  EXPECT_EQ(line[30], command[42]);
  EXPECT_EQ(line.size(), static_cast<std::size_t>(45 + (line[42] | line[43] << 8)));
  EXPECT_EQ(line[13] | line[14] << 8, static_cast<int>(line.size()) - 14);
}

// 9.2, in the order of the ROCK component.
TEST_P(Clients, Rock) {
  Driver driver(GetParam());
  const Bytes command = fixture("head_command_rock");
  driver.write(command);
  ASSERT_TRUE(driver.await(MessageType::alive, 2s, [](const Bytes& alive) {
    return (alive[20] & 0x82) != 0 || (alive[20] & 0x40) == 0;
  }));
  driver.write("send_bb_user");
  const auto blocks = driver.await(MessageType::bb_user_data, 1s);
  ASSERT_TRUE(blocks);
  ASSERT_EQ(blocks->size(), 264U);
  EXPECT_EQ((*blocks)[146], GetParam().half_duplex ? 1 : 0);
  for (int i = 0; i < 80; ++i) {
    driver.write("send_data");
    const auto line = driver.await_line(1s);
    ASSERT_TRUE(line) << i;
    expect_echo(command, *line);
    EXPECT_EQ(bearing_of(*line), (3200 - 88 * i + 2 * 6400) % 6400);
  }
}

// 9.2, the calls of the ROCK library: reboot, version, duplex, then several configurations.
TEST_P(Clients, RockLibrary) {
  Driver driver(GetParam());
  driver.write("reboot");
  driver.flush();
  ASSERT_TRUE(driver.await_alive(0, 0, 2s));
  driver.write("send_version");
  const auto version = driver.await(MessageType::version_data, 1s);
  ASSERT_TRUE(version);
  EXPECT_EQ(version->size(), 25U);
  driver.sleep(5s);
  for (const std::uint8_t step : {17, 88, 177}) {
    Bytes command = fixture("head_command_rock");
    command[50] = step;
    driver.write(command);
    ASSERT_TRUE(driver.await_alive(0, 0, 2s));
    for (int i = 0; i < 10; ++i) {
      driver.write("send_data");
      const auto line = driver.await_line(1s);
      ASSERT_TRUE(line);
      expect_echo(command, *line);
    }
  }
}

// 9.3. The start takes 4.4 s: 0.7 s to the first alive, and 1.7 s for the boot and an alive of the centring
// head. Two alives later the head has its parameters.
TEST_P(Clients, Uxv) {
  Driver driver(GetParam());
  const TimePoint begin = driver.bench().now;
  ASSERT_TRUE(driver.await_alive(0, 0, 1500ms));
  driver.write("reboot");
  driver.sleep(1s);
  driver.flush();
  ASSERT_TRUE(driver.await_alive(0x02, 0x84, 30s));
  driver.write("send_version");
  ASSERT_TRUE(driver.await(MessageType::version_data, 4s));
  driver.write("send_bb_user");
  const auto blocks = driver.await(MessageType::bb_user_data, 4s);
  ASSERT_TRUE(blocks);
  ASSERT_EQ((*blocks)[19], 15);
  const auto calibration = driver.await(MessageType::fpga_cal_data, 4s);
  ASSERT_TRUE(calibration);
  EXPECT_EQ(calibration->size(), 80U);
  const auto fpga_version = driver.await(MessageType::fpga_version_data, 4s);
  ASSERT_TRUE(fpga_version) << "in this order";
  EXPECT_EQ(fpga_version->size(), 28U);
  ASSERT_TRUE(driver.await_alive(0xC0, 0, 10s));
  driver.write("head_command_uxv");
  ASSERT_TRUE(driver.await_alive(0, 0x40, 10s));
  const double took_s = std::chrono::duration<double>(driver.bench().now - begin).count();
  EXPECT_NEAR(took_s, 4.4, 0.1);

  std::vector<int> bearings;
  for (int i = 0; i < 120; ++i) {
    driver.write("send_data");
    const auto line = driver.await_line(1500ms);
    ASSERT_TRUE(line);
    EXPECT_EQ(line->size(), 245U);
    bearings.push_back(bearing_of(*line));
  }
  EXPECT_EQ(bearings[25], 2400) << "90 degrees ahead, to the left first";
  EXPECT_EQ(bearings[75], 4000);
  driver.write("reverse");
  driver.write("gain");
  driver.sleep(500ms);
  driver.flush();
  driver.write("send_data");
  const auto line = driver.await_line(1500ms);
  ASSERT_TRUE(line);
  EXPECT_EQ((*line)[18] & 0x04, 0x04);
  EXPECT_EQ((*line)[26], 84);
}

// 9.4: reboots, waits for a head that is centred and at rest, repeats requests, keeps requests ahead.
TEST_P(Clients, Cauv) {
  Driver driver(GetParam());
  driver.write("reboot");
  ASSERT_TRUE(driver.await_alive(0x0A, 0x04, 10s));
  driver.write("send_version");
  ASSERT_TRUE(driver.await(MessageType::version_data, 3s));
  Bytes command = fixture("head_command_ros");
  command[16] = 0x0B;
  driver.write(command);
  ASSERT_TRUE(driver.await_alive(0, 0x40, 3s));
  driver.write("send_data");
  driver.write("send_data");
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(driver.await_line(3s)) << "3 s of silence, and it reboots the head";
    driver.write("send_data");
  }
}

// 9.4: the long form with a gain block, a wait of 5 s, another request after 1.5 s, gain changes while
// scanning.
TEST_P(Clients, ProviderSonar) {
  Driver driver(GetParam());
  driver.sleep(1s);
  driver.write("reboot");
  ASSERT_TRUE(driver.await_alive(0, 0, 5s));
  int tries = 0;
  do {
    ASSERT_LT(tries++, 3);
    driver.write("send_version");  // the first request is lost, because the alive was from before the reboot
  } while (!driver.await(MessageType::version_data, 1s));
  const auto alive = driver.await(MessageType::alive, 2s);
  ASSERT_TRUE(alive);
  ASSERT_TRUE((*alive)[20] & 0x40);
  driver.write("head_command_gain_block");
  driver.sleep(6s);
  driver.flush();
  for (int i = 0; i < 30; ++i) {
    driver.write("send_data");
    ASSERT_TRUE(driver.await_line(1500ms));
  }
  driver.write("gain");
  driver.sleep(500ms);
  driver.flush();
  driver.write("send_data");
  const auto line = driver.await_line(1500ms);
  ASSERT_TRUE(line);
  EXPECT_EQ((*line)[29], 63);
  EXPECT_EQ((*line)[30], 15);
}

// 9.4: polls at its own pace and never repeats a request.
TEST_P(Clients, ProjectRinzler) {
  Driver driver(GetParam());
  ASSERT_TRUE(driver.await_alive(0, 0, 2s));
  driver.write("send_version");
  ASSERT_TRUE(driver.await(MessageType::version_data, 1s));
  ASSERT_TRUE(driver.await_alive(0, 0, 2s));
  Bytes command = fixture("head_command_gain_block");
  command[16] = 3;
  command[53] = 90;
  command[54] = 0;
  driver.write(command);
  ASSERT_TRUE(driver.await_alive(0x02, 0, 5s));
  for (int i = 0; i < 20; ++i) {
    driver.sleep(250ms);
    driver.write("send_data");
    const auto line = driver.await_line(1s);
    ASSERT_TRUE(line);
    EXPECT_EQ(line->size(), 135U);
  }
}

// 9.4, the C client of 2024: long pauses, no alives, short lines. It discards all bytes that arrive in a
// pause.
TEST_P(Clients, LinuxC) {
  Driver driver(GetParam());
  driver.sleep(5s);
  driver.write("stop_alives");
  driver.sleep(2s);
  driver.flush();
  const std::size_t alives = driver.bench().all<Alive>().size();
  driver.write("send_version");
  ASSERT_TRUE(driver.await(MessageType::version_data, 1s));
  driver.sleep(2s);
  Bytes command = fixture("head_command_gain_block");
  command[53] = 20;
  command[54] = 0;
  driver.write(command);
  driver.sleep(2s);
  for (int i = 0; i < 30; ++i) {
    driver.flush();
    driver.write("send_data");
    const auto line = driver.await_line(1s);
    ASSERT_TRUE(line);
    EXPECT_EQ(line->size(), 65U);
  }
  EXPECT_EQ(driver.bench().all<Alive>().size(), alives);
}

constexpr Link clean{"clean"};
constexpr Link split{.name = "split", .split = true};
constexpr Link noisy{.name = "noisy", .noise = true};
constexpr Link poor{.name = "split_and_noisy", .split = true, .noise = true};
constexpr Link half{.name = "half_duplex", .half_duplex = true};

std::string link_name(const ::testing::TestParamInfo<Link>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(links, Clients, ::testing::Values(clean, split, noisy, poor, half), link_name);

// These drivers expect two lines per request.
class FullDuplexClients : public ::testing::TestWithParam<Link> {};
INSTANTIATE_TEST_SUITE_P(links, FullDuplexClients, ::testing::Values(clean, split, noisy, poor, fresh),
                         link_name);

// 9.4: reads exactly 264 bytes of user blocks, and sends parameters until byte 13 of an alive is 0.
TEST_P(FullDuplexClients, MinikingLibrary) {
  Driver driver(GetParam());
  ASSERT_TRUE(driver.await_alive(0, 0, 2s));
  driver.write("send_version");
  ASSERT_TRUE(driver.await(MessageType::version_data, 1s));
  driver.write("send_bb_user");
  const auto blocks = driver.await(MessageType::bb_user_data, 1s);
  ASSERT_TRUE(blocks);
  ASSERT_EQ(blocks->size(), 264U);
  EXPECT_EQ((*blocks)[59], 1) << "has a motor";
  EXPECT_EQ((*blocks)[99], 0);
  int tries = 0;
  do {
    ASSERT_LT(tries++, 10);
    driver.write("head_command_rock");
    ASSERT_TRUE(driver.await_alive(0, 0, 2s));
  } while ((*driver.await(MessageType::alive, 2s))[13] != 0);
  for (int i = 0; i < 30; ++i) {
    driver.write("send_data");
    ASSERT_TRUE(driver.await_line(5s));
    ASSERT_TRUE(driver.await_line(1s));
  }
}

// 9.4: stops the alives and continues without them.
TEST_P(FullDuplexClients, Uwe) {
  Driver driver(GetParam());
  ASSERT_TRUE(driver.await_alive(0, 0, 2s));
  driver.write("stop_alives");
  driver.write("send_version");
  ASSERT_TRUE(driver.await(MessageType::version_data, 1s));
  Bytes command = fixture("head_command_gain_block");
  command[16] = 3;
  driver.write(command);
  driver.sleep(100ms);
  const std::size_t before = driver.bench().all<Alive>().size();
  for (int i = 0; i < 30; ++i) {
    driver.write("send_data");
    ASSERT_TRUE(driver.await_line(5s));
    ASSERT_TRUE(driver.await_line(1s));
  }
  EXPECT_EQ(driver.bench().all<Alive>().size(), before);
}

// 9.4: a reboot whose stated length is too long, a pause of one second, parameters and a request. The driver
// never reads an alive, so no command from one second after the reboot may be lost.
TEST_P(FullDuplexClients, Acfr) {
  Driver driver(GetParam());
  driver.sleep(1s);
  driver.write(Bytes{0x40, 0x30, 0x30, 0x30, 0x43, 0x0C, 0x00, 0xFF, 0x02, 0x07, 0x10, 0x80, 0x02, 0x0A});
  driver.sleep(1s);
  driver.flush();
  EXPECT_EQ(driver.bench().device.counters().boots, 1U);
  Bytes command = fixture("head_command_ros");
  command[9] = 56;
  command[16] = 0x0B;
  driver.write(command);
  driver.sleep(1ms);
  driver.write("send_data");
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(driver.await_line(i == 0 ? 10s : 1s));
    ASSERT_TRUE(driver.await_line(1s));
    driver.write("send_data");
  }
}

TEST(Clients, WholeSessionInOneRead) {
  Bench bench;
  bench.run_until(10s);
  Bytes all;
  for (const char* name : {"send_version", "send_bb_user", "head_command_uxv", "send_data", "gain"}) {
    const Bytes one = fixture(name);
    all.insert(all.end(), one.begin(), one.end());
  }
  bench.raw(all);
  bench.run_for(2s);
  EXPECT_EQ(bench.all<VersionData>().size(), 1U);
  EXPECT_EQ(bench.all<BBUserData>().size(), 1U);
  ASSERT_EQ(bench.all<HeadData>().size(), 2U);
  EXPECT_EQ(bench.all<HeadData>()[0].second.gain, 84);
}

}  // namespace
}  // namespace sonard::micron
