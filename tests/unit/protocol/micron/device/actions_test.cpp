// SPDX-License-Identifier: Apache-2.0
// Actions of a head besides frames: log lines, cancelled jobs, statistics.
#include <algorithm>
#include <string_view>

#include "bench.hpp"

namespace sonard::micron {
namespace {

using Texts = std::vector<std::string>;

Texts texts(const std::vector<Notice>& notices, Notice::Level level) {
  Texts texts;
  for (const Notice& notice : notices) {
    if (notice.level == level) {
      texts.push_back(notice.text);
    }
  }
  return texts;
}

Texts states(const Bench& bench) {
  return texts(bench.notices, Notice::Level::info);
}
Texts warnings(const Bench& bench) {
  return texts(bench.notices, Notice::Level::warning);
}

TEST(Notices, TellOfTheStatesFromPowerToAScan) {
  Bench bench;
  EXPECT_EQ(states(bench), Texts{"without_parameters"});
  bench.run_until(5s);
  EXPECT_EQ(states(bench).size(), 1U) << "once";
  bench.command(all_round());
  EXPECT_EQ(states(bench), (Texts{"without_parameters", "ready"})) << "at once";
  bench.run_for(2s);
  bench.command(SendData{});
  EXPECT_EQ(states(bench), (Texts{"without_parameters", "ready", "scanning"}));
}

TEST(Notices, TellOfAReboot) {
  Bench bench;
  bench.make_ready(all_round());
  bench.notices.clear();
  const TimePoint reboot = bench.now;
  bench.command(Reboot{});
  EXPECT_EQ(states(bench), Texts{"booting"});
  bench.run_until(reboot + 699ms);
  EXPECT_EQ(states(bench), Texts{"booting"});
  bench.run_until(reboot + 700ms);
  EXPECT_EQ(states(bench), (Texts{"booting", "centring"}));
  bench.run_until(reboot + 10s);
  EXPECT_EQ(states(bench), (Texts{"booting", "centring", "without_parameters"}));
}

TEST(Notices, TellOfPowerThatFails) {
  Bench bench;
  bench.make_ready(all_round());
  bench.notices.clear();
  bench.power_cycle();
  EXPECT_EQ(states(bench), Texts{"booting"});
}

TEST(Notices, SayReadyWhenNothingHasBeenAskedForInTwoSeconds) {
  Bench bench;
  bench.make_ready(all_round());
  bench.scan(10);
  bench.run_for(1s);  // the lines still owed
  const TimePoint last_line = bench.all<HeadData>().back().first;
  ASSERT_EQ(bench.device.state(bench.now), HeadState::ready);
  EXPECT_EQ(states(bench).back(), "scanning");
  bench.run_until(last_line + 2s - 1ms);
  EXPECT_EQ(states(bench).back(), "scanning");
  bench.run_until(last_line + 3s);  // the next alive updates the state
  EXPECT_EQ(states(bench).back(), "ready");
  bench.run_for(20s);
  EXPECT_EQ(states(bench), (Texts{"without_parameters", "ready", "scanning", "ready"}));
}

TEST(Notices, SayNothingOfAClientThatLetsTheHeadBeReadyBetweenTwoLines) {
  DeviceConfig config;
  config.half_duplex = true;
  Bench bench(config);
  bench.make_ready(all_round());
  bench.notices.clear();
  for (int line = 0; line < 20; ++line) {
    bench.command(SendData{});
    bench.run_for(1900ms);
    EXPECT_EQ(bench.device.state(bench.now), HeadState::ready);
  }
  EXPECT_EQ(bench.all<HeadData>().size(), 20U);
  EXPECT_EQ(states(bench), Texts{"scanning"});
}

TEST(Notices, OfAnotherStateDoNotWaitForTwoSeconds) {
  Bench bench;
  bench.make_ready(all_round());
  bench.scan(2);
  bench.run_for(1s);
  ASSERT_EQ(bench.device.state(bench.now), HeadState::ready);
  EXPECT_EQ(states(bench).back(), "scanning");
  bench.command(Reboot{});
  EXPECT_EQ(states(bench).back(), "booting");
}

TEST(Warnings, OfAGainBeyondTheMostThereIsComeOnce) {
  Bench bench;
  HeadCommand command = all_round();
  command.gain[0] = 210;
  bench.command(command);
  EXPECT_EQ(warnings(bench), Texts{});
  command.gain[0] = 211;
  bench.command(command);
  EXPECT_EQ(texts(bench.last.notices, Notice::Level::warning),
            Texts{"the client's gain byte 211 is beyond 210, the maximum: the head uses 80 dB"});
  command.gain[0] = 255;
  bench.command(command);
  bench.command(Reboot{});
  bench.run_for(5s);
  bench.command(command);
  EXPECT_EQ(warnings(bench).size(), 1U);
}

TEST(Warnings, OfBinsAndIntervalsThatTheHeadClampsComeOnce) {
  Bench bench;
  HeadCommand command = all_round();
  command.bins = 1501;
  bench.command(command);
  EXPECT_EQ(warnings(bench), Texts{"the client requests 1501 bins (expected 1 to 1500): the head uses 1500"});
  command.bins = 0;
  command.ad_interval = 0;
  bench.command(command);
  EXPECT_EQ(warnings(bench).size(), 2U);
  EXPECT_EQ(warnings(bench).back(), "the client's ad_interval is 0: the head uses 1");
  EXPECT_EQ(bench.device.counters().out_of_range, 2U) << "commands, not values";
}

TEST(Warnings, OfEqualLimitsComeOnce) {
  Bench bench;
  bench.command(sector(1600, 1600));
  EXPECT_EQ(warnings(bench), Texts{"the client's sector has equal limits (1600): the head holds still there; "
                                   "a whole turn is 0 to 6400"});
  bench.command(sector(1600, 1600));
  bench.command(sector(800, 800));
  EXPECT_EQ(warnings(bench).size(), 1U);
}

TEST(Warnings, OfEqualLimitsAreNotForAClientThatMeansThem) {
  for (const std::uint16_t control : {0x3305, 0x2315, 0x2307}) {  // stare, motor off, continuous
    Bench bench;
    HeadCommand command = sector(1600, 1600);
    command.control = control;
    bench.command(command);
    EXPECT_EQ(warnings(bench), Texts{}) << control;
  }
  Bench whole_turn;
  whole_turn.command(sector(0, 6400));
  EXPECT_EQ(warnings(whole_turn), Texts{});
}

TEST(Warnings, OfSidesThatAreSwappedComeOnce) {
  for (const bool inverted : {false, true}) {
    DeviceConfig config;
    config.mounted_inverted = inverted;
    Bench bench(config);
    HeadCommand command = all_round();
    command.control = static_cast<std::uint16_t>(inverted ? command.control | control_bits::invert
                                                          : command.control & ~control_bits::invert);
    bench.command(command);
    EXPECT_EQ(warnings(bench), Texts{}) << "both agree";
    command.control ^= control_bits::invert;
    bench.command(command);
    bench.command(command);
    EXPECT_EQ(
        warnings(bench),
        Texts{inverted
                  ? "left and right are swapped: the client's invert bit is for a head mounted boot up, "
                    "`device.mounted_inverted` for one mounted boot down"
                  : "left and right are swapped: the client's invert bit is for a head mounted boot down, "
                    "`device.mounted_inverted` for one mounted boot up"});
  }
}

TEST(Warnings, ComeTogetherAndEachForItself) {
  Bench bench;
  HeadCommand command = sector(1600, 1600);
  command.control |= control_bits::invert;
  command.gain[0] = 255;
  bench.command(command);
  EXPECT_EQ(warnings(bench).size(), 3U);
}

TEST(Warnings, AreNotForAHeadThatPlaysBack) {
  DeviceConfig config;
  config.plays_back = true;
  Bench bench(config);
  HeadCommand command = sector(1600, 1600);
  command.control |= control_bits::invert;
  command.gain[0] = 255;
  bench.command(command);
  EXPECT_EQ(warnings(bench), Texts{}) << "it does not heed them";
}

TEST(Cancelled, NamesTheJobThatNobodyWantsUntilItIsAnswered) {
  Bench bench;
  bench.make_ready(all_round());
  bench.renderer_answers = false;
  bench.command(SendData{});
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  bench.command(all_round(64));
  EXPECT_EQ(bench.last.cancelled, 0U);
  bench.run_for(5s);
  EXPECT_EQ(bench.last.cancelled, 0U);
  EXPECT_EQ(bench.jobs.size(), 1U) << "at most one job is out";
  bench.step(PingNotRendered{0});
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  ASSERT_EQ(bench.jobs.size(), 2U) << "both lines are still owed";
  EXPECT_EQ(bench.jobs[1].number, 1U);
  EXPECT_EQ(bench.device.counters().pings_cancelled, 1U);
  EXPECT_EQ(bench.device.counters().pings_failed, 0U);
}

TEST(Frames, AreForEverybodyOnTheLine) {
  Bench bench;
  bench.make_ready(all_round());
  bench.command(SendData{});
  for (std::size_t frames = 0; frames < 5;) {
    bench.run_once();
    frames += bench.last.send.size();
    for (const Outgoing& frame : bench.last.send) {
      EXPECT_EQ(frame.to, Outgoing::To::everybody);
    }
  }
}

TEST(Jobs, SayWhatTheClientHasSet) {
  Bench bench;
  HeadCommand command = sector(2400, 4000, 16);
  command.ad_low = 40;
  command.ad_span = 77;
  command.gain[0] = 84;
  command.bins = 400;
  bench.make_ready(command);
  bench.command(SendData{});
  EXPECT_EQ(bench.jobs.at(0).settings, (std::vector<Setting>{{"range", "10.18m"},
                                                             {"bins", "400"},
                                                             {"bin", "25.4mm"},
                                                             {"gain", "32.0dB"},
                                                             {"window", "12.5+24.2dB"},
                                                             {"bits", "8"},
                                                             {"scan", "sector"},
                                                             {"from", "-45.00deg"},
                                                             {"to", "45.00deg"},
                                                             {"step", "0.90deg"},
                                                             {"direction", "right"},
                                                             {"inverted", "no"}}));
}

PingJob job_of(const HeadCommand& command, const DeviceConfig& config = {}) {
  Bench bench(config);
  bench.make_ready(command);
  bench.command(SendData{});
  return bench.jobs.at(0);
}

TEST(Jobs, SayHowTheHeadScans) {
  const PingJob round = job_of(all_round(0, false));
  EXPECT_EQ(setting(round, "scan"), "all_round");
  EXPECT_EQ(setting(round, "from"), "");
  EXPECT_EQ(setting(round, "step"), "0.90deg") << "0 acts as 16";
  EXPECT_EQ(setting(round, "direction"), "left");
  EXPECT_EQ(setting(job_of(sector(0, 6400)), "scan"), "sector_all_round");

  const PingJob stares = job_of(sector(4000, 4000));
  EXPECT_EQ(setting(stares, "scan"), "stares");
  EXPECT_EQ(setting(stares, "at"), "45.00deg");
  EXPECT_EQ(setting(stares, "direction"), "");

  HeadCommand command = all_round();
  command.control |= control_bits::motor_off;
  EXPECT_EQ(setting(job_of(command), "scan"), "motor_off");
}

TEST(Jobs, SayWhereTheHeadScansByTheOrderOfLimits) {
  DeviceConfig config;
  EXPECT_EQ(setting(job_of(sector(4800, 1600), config), "from"), "90.00deg") << "through astern";
  config.limits_order = LimitsOrder::swapped;
  EXPECT_EQ(setting(job_of(sector(4800, 1600), config), "from"), "-90.00deg");
}

TEST(Jobs, SayWhatIsUnusualAboutAPing) {
  HeadCommand command = all_round();
  EXPECT_EQ(setting(job_of(command), "transmit"), "");
  command.control = 0x2306 | control_bits::invert | control_bits::transmit_off;
  const PingJob job = job_of(command);
  EXPECT_EQ(setting(job, "transmit"), "off");
  EXPECT_EQ(setting(job, "bits"), "4");
  EXPECT_EQ(setting(job, "inverted"), "yes");
}

TEST(Jobs, HaveTheTimeSincePowerCame) {
  Bench bench;
  bench.make_ready(all_round());
  bench.command(SendData{61'891'786});  // sets the clock of alives, not the clock of jobs
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.jobs[0].transmit_time, bench.now);
  EXPECT_EQ(bench.jobs[0].transmit_us, static_cast<std::uint64_t>(bench.now / 1us));
}

std::optional<Counter> counter(const Device& device, std::string_view name) {
  const std::vector<Counter> counts = device.counts();
  const auto found = std::ranges::find(counts, name, &Counter::name);
  return found == counts.end() ? std::nullopt : std::optional(*found);
}

TEST(Counts, AreThoseOfTheHead) {
  Bench bench;
  bench.command(SendData{});  // before any parameters
  bench.make_ready(all_round());
  bench.scan(10);
  bench.run_for(1s);
  Bytes other = fixture("send_version");
  other[8] = 3;
  bench.raw(other);
  bench.raw(Bytes{1, 2, 3});
  EXPECT_EQ(counter(bench.device, "lines_sent").value().value, bench.all<HeadData>().size());
  EXPECT_EQ(counter(bench.device, "commands").value().value, bench.device.counters().commands);
  EXPECT_EQ(counter(bench.device, "not_ready").value().value, 1U);
  EXPECT_EQ(counter(bench.device, "not_ready").value().warning, "{} requests came before the parameters");
  EXPECT_EQ(counter(bench.device, "wrong_node").value().value, 1U);
  EXPECT_EQ(counter(bench.device, "wrong_node").value().shown, Counter::Shown::warns);
  EXPECT_EQ(counter(bench.device, "wrong_node").value().warning, "{} commands were for another node");
  EXPECT_EQ(counter(bench.device, "dropped_bytes").value().value, 3U);
  EXPECT_EQ(counter(bench.device, "dropped_bytes").value().shown, Counter::Shown::warns);
  EXPECT_EQ(counter(bench.device, "boots").value().shown, Counter::Shown::at_end);
}

TEST(Counts, OfWhatTheHeadRefusesIgnoresOrChangesAreFaultsOfTheClient) {
  Bench bench;
  HeadCommand command = all_round();
  command.gain[0] = 211;
  bench.make_ready(command);
  GainCommand gain;
  gain.values.gain[0] = 255;
  bench.command(gain);
  Bytes unknown = fixture("send_version");
  unknown[10] = 99;
  bench.raw(unknown);
  Bytes form = fixture("head_command_ros");
  form[13] = 0x55;
  bench.raw(form);
  for (const auto& [name, count] :
       {std::pair{"out_of_range", 2U}, {"unknown_type", 1U}, {"bad_frames", 1U}}) {
    EXPECT_EQ(counter(bench.device, name).value().value, count) << name;
    EXPECT_EQ(counter(bench.device, name).value().fault, Counter::Fault::of_client) << name;
  }
  EXPECT_EQ(counter(bench.device, "unknown_type").value().shown, Counter::Shown::warns);
  EXPECT_EQ(counter(bench.device, "requests_beyond_cap").value().fault, Counter::Fault::none);
}

TEST(Progress, GrowsWithLinesAndWithPingsThatComeToNothing) {
  Bench bench;
  bench.make_ready(all_round());
  bench.command(SendData{});
  bench.run_for(1s);
  EXPECT_EQ(bench.device.progress().sent, 2U);
  EXPECT_EQ(bench.device.progress().ended, 2U);
  EXPECT_EQ(bench.device.progress().messages, 2U);
  bench.renderer_fails = true;
  bench.command(SendData{});
  bench.run_for(1s);
  EXPECT_EQ(bench.device.progress().sent, 2U);
  EXPECT_EQ(bench.device.progress().ended, 4U);
  bench.renderer_answers = false;
  bench.command(SendData{});
  bench.command(Reboot{});
  EXPECT_EQ(bench.device.progress().ended, 5U) << "one was out, the other not begun";
}

}  // namespace
}  // namespace sonard::micron
