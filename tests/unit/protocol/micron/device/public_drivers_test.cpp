// SPDX-License-Identifier: Apache-2.0
// Loops of public drivers: when each gives up, what it checks first, what it repeats.
// docs/your-micron-driver.md lists the drivers and their sources. Each test is named after the defect that
// its driver has shown.
#include <numbers>

#include "driver.hpp"

namespace sonard::micron {
namespace {

constexpr Link steady{"steady"};

bool is_alive(const Bytes& frame) {
  return frame[10] == static_cast<std::uint8_t>(MessageType::alive);
}
bool is_line(const Bytes& frame) {
  return frame[10] == static_cast<std::uint8_t>(MessageType::head_data);
}
bool says_no_parameters(const Bytes& alive) {
  return (alive[20] & head_info_bits::no_parameters) != 0;
}

HeadCommand with_limits(std::uint16_t left, std::uint16_t right) {
  HeadCommand command = sector(left, right, 64);
  command.bins = 200;
  return command;
}

// libminiking and miniking_ros. It reads the user blocks and takes the next message for an alive; any other
// type ends it. It sends its parameters at least once, until byte 13 of the next alive is 0. The node later
// changes them in this way too. From then on it sends one request for two lines and waits for both, again and
// again.
TEST(PublicDrivers, S1ParametersRepeatedUntilAnAliveIsContent) {
  DeviceConfig config;
  config.user_blocks = UserBlocks::dst_alone;
  Driver driver(steady, config);
  ASSERT_TRUE(is_alive(*driver.read(2s)));
  driver.write("send_version");
  ASSERT_TRUE(driver.await(MessageType::version_data, 1s));
  driver.write("send_bb_user");
  ASSERT_EQ(driver.read(1s)->size(), 264U);
  const auto next = driver.read(2s);
  ASSERT_TRUE(next && is_alive(*next)) << "anything else is a null pointer to it";
  for (int change = 0; change < 3; ++change) {
    Bytes command = fixture("head_command_ros");
    command[50] = static_cast<std::uint8_t>(16 + change);
    for (int tries = 1;; ++tries) {
      ASSERT_LE(tries, 2) << "it would go on for ever";
      driver.write(command);
      const auto alive = driver.await(MessageType::alive, 2s);
      ASSERT_TRUE(alive);
      if ((*alive)[13] == 0) {
        break;
      }
    }
  }
  for (int i = 0; i < 50; ++i) {
    driver.write("send_data");
    ASSERT_TRUE(driver.await_line(2s));
    ASSERT_TRUE(driver.await_line(2s));
  }
}

// iSonar of moos-ivp-enstabretagne. 0.1 s after each message it sends one command: the request for the
// version or for the user blocks, or its parameters, if it still lacks them. It sends parameters until an
// alive has bit 7 set and bit 6 clear.
TEST(PublicDrivers, S1ParametersSentAfterEveryAliveUntilOneIsContent) {
  Driver driver(steady);
  bool has_version = false, has_blocks = false;
  int commands = 0;
  std::size_t lines = 0;
  for (int messages = 0; lines < 50; ++messages) {
    ASSERT_LT(messages, 200);
    const auto frame = driver.read(2s);
    ASSERT_TRUE(frame);
    driver.sleep(100ms);
    has_version = has_version || (*frame)[10] == 1;
    has_blocks = has_blocks || (*frame)[10] == 6;
    lines += is_line(*frame) ? 1 : 0;
    const bool content =
        lines > 0 || (is_alive(*frame) && !says_no_parameters(*frame) && ((*frame)[20] & 0x80) != 0);
    if (content || is_line(*frame)) {
      driver.write("send_data");
    } else if (!has_version) {
      driver.write("send_version");
    } else if (!has_blocks) {
      driver.write("send_bb_user");
    } else {
      ASSERT_LT(commands++, 10) << "it would send its parameters for ever";
      driver.write("head_command_uxv");
    }
  }
}

TEST(PublicDrivers, S1ARepeatedHeadCommandChangesNothingInWhatAlivesSay) {
  Driver driver(steady);
  driver.write("head_command_ros");
  ASSERT_TRUE(driver.await_alive(0, 0, 2s));
  driver.sleep(3s);
  driver.flush();
  const auto before = driver.await(MessageType::alive, 2s);
  ASSERT_TRUE(before);
  EXPECT_EQ((*before)[13], 0);
  EXPECT_EQ((*before)[20], 0x8A);
  for (int i = 0; i < 20; ++i) {
    driver.write("head_command_ros");
    const auto alive = driver.await(MessageType::alive, 2s);
    ASSERT_TRUE(alive);
    EXPECT_EQ((*alive)[13], (*before)[13]) << i;
    EXPECT_EQ((*alive)[20], (*before)[20]) << i;
  }
}

// A Python script that sends no time. Two forms: as recorded, with one digit too many in the length, and
// corrected.
TEST(PublicDrivers, S2SendDataWithoutItsTime) {
  const Bytes recorded{0x40, 0x30, 0x30, 0x30, 0x38, 0x38, 0x08, 0x00,
                       0xFF, 0x02, 0x03, 0x19, 0x80, 0x02, 0x0A};
  Bytes meant = recorded;
  meant.erase(meant.begin() + 5);
  for (const Bytes& request : {recorded, meant}) {
    for (const Link& link :
         {steady, Link{.name = "split", .split = true}, Link{.name = "noisy", .noise = true}}) {
      Driver driver(link);
      driver.write("head_command_ros");
      driver.sleep(2s);
      const std::uint32_t clock_ms = driver.bench().all<Alive>().back().second.time_ms;
      for (int i = 0; i < 10; ++i) {
        driver.write(request);
        ASSERT_TRUE(driver.await_line(1s)) << link.name << " " << i;
      }
      driver.sleep(1s);
      EXPECT_LT(driver.bench().all<Alive>().back().second.time_ms, clock_ms + 5000)
          << "0: it keeps its clock";
    }
  }
}

/// A driver that reboots the head and sends its commands one second later. It repeats nothing. A message
/// other than a line, more than two seconds after the last line or the programming, makes it begin again.
struct Watchdog {
  Driver& driver;
  Bytes command = fixture("head_command_ros");
  int programmed = 0;
  TimePoint last_line{};

  void program() {
    ++programmed;
    last_line = driver.bench().now;
    driver.write("reboot");
    driver.sleep(1s);
    driver.write(command);
    driver.write("send_data");
  }
  /// Runs until `end` and returns the number of lines.
  std::size_t run_until(TimePoint end) {
    std::size_t lines = 0;
    while (driver.bench().now < end) {
      const auto frame = driver.read(end - driver.bench().now);
      if (frame && is_line(*frame)) {
        last_line = driver.bench().now;
        lines += 1;
        driver.write("send_data");
      } else if (frame && driver.bench().now - last_line > 2s) {
        program();
      }
    }
    return lines;
  }
};

/// Parameters of 500 bins of 312 units each: 75 m, the longest range of a Micron.
Bytes longest_lines() {
  HeadCommand command = with_limits(0, 6400);
  command.bins = 500;
  command.ad_interval = 312;
  return encode(command);
}

// With and without an immediate answer of the head, with short and long lines, and with a slow renderer.
TEST(PublicDrivers, S3AWatchdogOfTwoSecondsSeesLinesBeforeItFires) {
  for (const bool alive_after_head_command : {false, true}) {
    for (const Bytes& command : {fixture("head_command_ros"), longest_lines()}) {
      for (const auto render_time : {5ms, 500ms}) {
        DeviceConfig config;
        config.alive_after_head_command = alive_after_head_command;
        Driver driver(steady, config);
        driver.bench().render_time = render_time;
        Watchdog watchdog{driver, command};
        watchdog.program();
        EXPECT_GT(watchdog.run_until(driver.bench().now + 20s), 25U);
        EXPECT_EQ(watchdog.programmed, 1) << "it would begin again and again";
      }
    }
  }
}

// A watchdog with a timer, and lines as drivers usually request them.
TEST(PublicDrivers, S3ALineComesWithinTwoSecondsOfAReboot) {
  Driver driver(steady);
  const TimePoint reboot = driver.bench().now;
  Watchdog{driver}.program();
  ASSERT_TRUE(driver.await_line(5s));
  EXPECT_LT(driver.bench().now - reboot, 2s);
}

/// Turns the head to this bearing. No lines are requested.
void leave_at(Driver& driver, int bearing) {
  driver.write(encode(with_limits(static_cast<std::uint16_t>(bearing), static_cast<std::uint16_t>(bearing))));
  driver.sleep(3s);
  driver.flush();
}

// Both conditions hold: the watchdog does not fire, and two alives show centring. Up to 150 degrees from the
// centre the motor needs no more than 1.67 s.
TEST(PublicDrivers, S3TwoAlivesOfCentringAndLinesBeforeAWatchdogFires) {
  for (int bearing = 550; bearing <= 5850; bearing += 530) {
    Driver driver(steady);
    leave_at(driver, bearing);
    driver.write("reboot");
    for (int i = 0; i < 2; ++i) {
      const auto alive = driver.await(MessageType::alive, 2s);
      ASSERT_TRUE(alive);
      EXPECT_EQ((*alive)[20] & 0x03, 0x01) << bearing;
    }
    driver.sleep(5s);
    leave_at(driver, bearing);
    Watchdog watchdog{driver};
    watchdog.program();
    EXPECT_GT(watchdog.run_until(driver.bench().now + 20s), 200U) << bearing;
    EXPECT_EQ(watchdog.programmed, 1) << bearing;
  }
}

// A motor that seeks twice as fast, from all bearings.
TEST(PublicDrivers, S3AFastMotorHasLinesBeforeAWatchdogFiresFromEverywhere) {
  for (int bearing = 0; bearing < 6400; bearing += 800) {
    DeviceConfig config;
    config.seek_speed_rad_s = std::numbers::pi;
    Driver driver(steady, config);
    leave_at(driver, bearing);
    Watchdog watchdog{driver};
    watchdog.program();
    EXPECT_GT(watchdog.run_until(driver.bench().now + 20s), 200U) << bearing;
    EXPECT_EQ(watchdog.programmed, 1) << bearing;
  }
}

// From all bearings. Half a turn takes two seconds, so the driver may have to begin twice, but no more often.
TEST(PublicDrivers, S3TheWayToTheCentreTakesAsLongAsItIs) {
  for (int bearing = 0; bearing < 6400; bearing += 400) {
    Driver driver(steady);
    leave_at(driver, bearing);
    Watchdog watchdog{driver};
    watchdog.program();
    EXPECT_GT(watchdog.run_until(driver.bench().now + 20s), 200U) << bearing;
    EXPECT_LE(watchdog.programmed, 2) << bearing;
  }
}

/// How drivers-sonar_tritech configures: it sends parameters and waits for any alive with bit 1, or bit 7, or
/// without bit 6. It discards lines that arrive before that alive. Returns false after 10 s without one.
bool rock_configure(Driver& driver, const Bytes& command) {
  driver.write(command);
  return driver
      .await(MessageType::alive, 10s,
             [](const Bytes& alive) { return (alive[20] & 0x82) != 0 || !says_no_parameters(alive); })
      .has_value();
}

Bytes rock_command(int left, int right, double step_deg, bool continuous) {
  Bytes command = fixture("head_command_rock");
  command[14] = continuous ? 0x83 : 0x81;
  command[37] = static_cast<std::uint8_t>(left & 0xFF);
  command[38] = static_cast<std::uint8_t>(left >> 8);
  command[39] = static_cast<std::uint8_t>(right & 0xFF);
  command[40] = static_cast<std::uint8_t>(right >> 8);
  command[50] = static_cast<std::uint8_t>(step_deg / 360.0 * 6399.0);
  return command;
}

// A program on the same library (drivers-sonar_tritech) that reboots the head and requests lines at once.
// Real heads keep it waiting too.
TEST(PublicDrivers, S4ARebootAndALineWithinItsSecondNeedAShortTimeOfCentring) {
  for (const auto centring : {500ms, 900ms}) {
    DeviceConfig config;
    config.least_centring_time = centring;
    Driver driver(steady, config);
    driver.write("reboot");
    driver.flush();
    ASSERT_TRUE(driver.await(MessageType::alive, 2s));
    ASSERT_TRUE(rock_configure(driver, fixture("head_command_rock")));
    driver.write("send_data");
    EXPECT_TRUE(driver.await_line(1s)) << centring.count();
  }
}

void rock_ten_beams(Driver& driver) {
  for (int i = 0; i < 10; ++i) {
    driver.write("send_data");
    ASSERT_TRUE(driver.await_line(1s)) << i;
  }
}

// test/test_micron.cpp of drivers-sonar_tritech: three full scans, then three sectors. Before each sector it
// waits for a line that it has not requested. Some versions of the driver swap the limits, so the test runs
// both ways.
TEST(PublicDrivers, S4HardwareTestThatTakesAnAliveForTheAnswer) {
  for (const bool swapped : {true, false}) {
    for (const int phase_ms : {0, 150, 300, 450, 600, 750, 900}) {
      Driver driver(steady);
      driver.sleep(std::chrono::milliseconds{phase_ms});
      driver.write("send_bb_user");
      ASSERT_TRUE(driver.await(MessageType::bb_user_data, 2s));
      for (const double step_deg : {1.0, 5.0, 10.0}) {
        ASSERT_TRUE(rock_configure(driver, rock_command(3199, 3199, step_deg, true)));
        ASSERT_NO_FATAL_FAILURE(rock_ten_beams(driver));
      }
      const std::pair<double, double> sectors_deg[] = {{-15, 15}, {15, 30}, {-15, -30}};
      for (std::size_t i = 0; i < 3; ++i) {
        const auto wire = [](double deg) { return static_cast<int>((deg + 180.0) / 360.0 * 6399.0); };
        auto [left, right] = sectors_deg[i];
        if (swapped) {
          std::swap(left, right);
        }
        ASSERT_TRUE(rock_configure(driver, rock_command(wire(left), wire(right), 5.0, false)));
        ASSERT_TRUE(driver.await_line(i == 0 ? 10s : 1s)) << "sector " << i << ", phase " << phase_ms;
        ASSERT_NO_FATAL_FAILURE(rock_ten_beams(driver));
      }
    }
  }
}

// DelphinROSv3: sends parameters, waits 0.1 s and reads once. It repeats this until it reads an alive,
// whatever the alive holds. It then discards all bytes received so far. Its commands have 0xFF as the second
// node number.
TEST(PublicDrivers, S4AnAliveIsThereATenthOfASecondAfterParameters) {
  Driver driver(steady);
  Bytes command = fixture("head_command_ros");
  command[12] = 0xFF;
  driver.flush();
  driver.write(command);
  driver.sleep(100ms);
  const auto answer = driver.read(0ms);
  ASSERT_TRUE(answer) << "it would send its parameters again";
  EXPECT_TRUE(is_alive(*answer));
  driver.flush();
  for (int i = 0; i < 20; ++i) {
    driver.write("send_data");
    ASSERT_TRUE(driver.await_line(2s));
  }
}

std::vector<int> bearings_asked_for(Driver& driver, std::size_t count) {
  std::vector<int> bearings;
  while (bearings.size() < count) {
    driver.write("send_data");
    const auto line = driver.await_line(2s);
    if (!line) {
      ADD_FAILURE() << "no line";
      break;
    }
    bearings.push_back(bearing_of(*line));
  }
  return bearings;
}

// The defaults of one driver: a sector from 0 to 6400.
TEST(PublicDrivers, S5ASectorOf6400IsAWholeTurn) {
  Driver driver(steady);
  driver.write(encode(with_limits(0, 6400)));
  ASSERT_TRUE(driver.await_alive(0, 0, 2s));
  const auto bearings = bearings_asked_for(driver, 150);
  // From ahead clockwise to astern, and back all the way round. 6400 and 0 are the two ends of the sector.
  EXPECT_EQ(bearings[0], 3200);
  EXPECT_EQ(bearings[1], 3264);
  EXPECT_EQ(bearings[50], 0);
  EXPECT_EQ(bearings[51], 6336);
  EXPECT_EQ(bearings[149], 64);
  const auto lines = driver.bench().all<HeadData>();
  EXPECT_EQ(lines[50].second.sweep, SweepCode::right_limit);
  EXPECT_EQ(lines[51].second.sweep, SweepCode::normal);
  EXPECT_EQ(lines[0].second.left_limit, 0);
  EXPECT_EQ(lines[0].second.right_limit, 6400);
}

// The defaults of early versions of drivers-sonar_tritech: 6399 twice. By the protocol the head then holds
// still.
TEST(PublicDrivers, S5EqualLimitsStare) {
  Driver driver(steady);
  driver.write(encode(with_limits(6399, 6399)));
  ASSERT_TRUE(driver.await_alive(0, 0, 2s));
  for (const int bearing : bearings_asked_for(driver, 20)) {
    EXPECT_EQ(bearing, 6399);
  }
  driver.write(encode(with_limits(6400, 6400)));
  EXPECT_EQ(bearings_asked_for(driver, 3).back(), 0);
}

// ProjectRinzler, whose reads have a timeout of one second. It waits for an alive, requests the version,
// reads one message that must be an alive, and sends its parameters. An alive that arrives just at the
// timeout hangs it, so the period is shorter here.
TEST(PublicDrivers, S6AClientOfOneSecondAtTheStartOfTheDaemon) {
  DeviceConfig config;
  config.alive_period = 900ms;
  for (const int phase_ms : {0, 1, 400, 890}) {
    Driver driver(fresh, config);
    driver.sleep(std::chrono::milliseconds{phase_ms});
    ASSERT_TRUE(driver.read(1s));
    driver.write("send_version");
    ASSERT_EQ((*driver.read(1s))[10], 1);
    ASSERT_TRUE(is_alive(*driver.read(1s)));
    driver.write("head_command_uxv");
    ASSERT_TRUE(is_alive(*driver.read(1s)));
    driver.write("send_data");
    ASSERT_TRUE(driver.await_line(1s)) << phase_ms;
    ASSERT_TRUE(driver.await_line(1s));
  }
}

TEST(PublicDrivers, S6AHeadThatNobodyRebootedIsCentredFromTheStart) {
  Bench bench;
  EXPECT_EQ(bench.device.state(bench.now), HeadState::without_parameters);
  ASSERT_EQ(bench.all<Alive>().size(), 1U);
  EXPECT_EQ(bench.all<Alive>()[0].second.head_info, 0x4A);
  bench.command(all_round());
  bench.command(SendData{});
  bench.run_for(1s);
  EXPECT_EQ(bench.all<HeadData>().size(), 2U);
}

// ProjectRinzler multiplies 210 by a factor above 1 and keeps the low byte.
TEST(PublicDrivers, S8AGainByteAbove210Is80DB) {
  for (const int gain : {210, 211, 232, 255}) {
    Bench bench;
    HeadCommand command = all_round();
    command.gain[0] = static_cast<std::uint8_t>(gain);
    bench.make_ready(command);
    const auto lines = bench.scan(1);
    EXPECT_DOUBLE_EQ(bench.jobs.at(0).gain_db, 80.0);
    EXPECT_EQ(lines.at(0).gain, gain) << "as it came";
  }
}

// libminiking reads 264 bytes of user blocks, and the next message must be an alive. If a head sends FPGA
// data after the blocks, libminiking ends. If a head sends 175 bytes, the alives that fill the rest are lost.
TEST(PublicDrivers, UserBlocksOf264BytesComeAloneIfSoSet) {
  for (const bool half_duplex : {false, true}) {
    DeviceConfig config;
    config.half_duplex = half_duplex;
    config.user_blocks = UserBlocks::dst_alone;
    Driver driver(steady, config);
    driver.write("send_bb_user");
    const auto blocks = driver.read(1s);
    ASSERT_TRUE(blocks);
    EXPECT_EQ(blocks->size(), 264U);
    EXPECT_EQ((*blocks)[19], 15);
    EXPECT_EQ((*blocks)[146], half_duplex ? 1 : 0);
    EXPECT_TRUE(is_alive(*driver.read(2s)));
  }
}

// MicronCore of ENSTA: its head command has 82 bytes, states 66 and ends with the line feed of the longer
// form. It takes the two messages after a request for lines, without checking their type.
TEST(PublicDrivers, AHeadCommandLongerThanItSaysIsTaken) {
  Bytes command = fixture("head_command_uxv");
  command.back() = 0x50;
  command.insert(command.end(), 15, 0x00);
  command.push_back(0x0A);
  ASSERT_EQ(command.size(), 82U);
  DeviceConfig config;
  config.alive_while_scanning = false;
  for (const Link& link : {steady, Link{.name = "split", .split = true}}) {
    Driver driver(link, config);
    driver.write("reboot");
    driver.sleep(2500ms);
    driver.flush();
    ASSERT_TRUE(driver.await(MessageType::alive, 2s, [](const Bytes& alive) { return alive[20] == 0x4A; }));
    driver.write(command);
    ASSERT_TRUE(driver.await(MessageType::alive, 2s, [](const Bytes& alive) { return alive[20] == 0x8A; }));
    driver.write("send_data");
    for (int i = 0; i < 200; ++i) {
      for (int line = 0; line < 2; ++line) {
        const auto frame =
            link.split ? driver.await_line(1s) : driver.read(1s);  // if split, an alive may come between
        ASSERT_TRUE(frame && is_line(*frame)) << i;
      }
      driver.write("send_data");
    }
    EXPECT_EQ(driver.bench().device.counters().dropped_bytes, 0U);
  }
}

}  // namespace
}  // namespace sonard::micron
