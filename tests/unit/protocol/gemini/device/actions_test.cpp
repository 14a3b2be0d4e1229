// SPDX-License-Identifier: Apache-2.0
// Actions of a head besides datagrams: log lines, cancelled jobs, statistics.
#include <algorithm>
#include <string_view>

#include "bench.hpp"

namespace sonard::gemini {
namespace {

std::vector<std::string> texts(const std::vector<Notice>& notices,
                               Notice::Level level = Notice::Level::info) {
  std::vector<std::string> texts;
  for (const Notice& notice : notices) {
    EXPECT_EQ(notice.level, level) << notice.text;
    texts.push_back(notice.text);
  }
  return texts;
}

using Texts = std::vector<std::string>;

TEST(Notices, TellOfAClientThatComesAndGoes) {
  Bench bench;
  bench.run_until(500ms);
  EXPECT_TRUE(bench.notices.empty()) << "nobody is there yet, and was not before";
  bench.command(to_head<StatusRequest>());
  EXPECT_EQ(texts(bench.last.notices), Texts{"client 192.168.2.5 connected"});
  bench.command(to_head<StatusRequest>());
  EXPECT_TRUE(bench.last.notices.empty()) << "once";
  bench.run_until(3499ms);
  EXPECT_EQ(bench.notices.size(), 1U);
  bench.run_until(3500ms);
  EXPECT_EQ(texts(bench.last.notices),
            Texts{"client 192.168.2.5 lost: no command within the time-out, or a reboot command"});
  bench.run_until(20s);
  EXPECT_EQ(bench.notices.size(), 2U);
  bench.command(to_head<StatusRequest>());
  EXPECT_EQ(texts(bench.last.notices), Texts{"client 192.168.2.5 connected"});
}

TEST(Notices, TellOfTheNewestClient) {
  Bench bench;
  bench.command(to_head<StatusRequest>());
  bench.command(to_head<NetworkConfig>(), other_client);
  EXPECT_EQ(texts(bench.notices), (Texts{"client 192.168.2.5 connected", "client 192.168.2.6 connected"}));
}

TEST(Notices, TellOfAClientThatRebootsTheHead) {
  Bench bench;
  bench.command(to_head<StatusRequest>());
  bench.command(to_head<Reboot>());
  EXPECT_EQ(texts(bench.notices),
            (Texts{"client 192.168.2.5 connected",
                   "client 192.168.2.5 lost: no command within the time-out, or a reboot command"}));
  bench.run_until(6s);
  bench.command(to_head<Reboot>());  // the first command of this client, and its last
  EXPECT_EQ(texts(bench.last.notices),
            (Texts{"client 192.168.2.5 connected",
                   "client 192.168.2.5 lost: no command within the time-out, or a reboot command"}));
}

TEST(Notices, CommandsForOthersConnectNobody) {
  Bench bench;
  StatusRequest request;
  request.header.sonar_id = 602;
  bench.command(request);
  bench.raw(from_hex("20 01"));
  EXPECT_TRUE(bench.notices.empty());
}

TEST(NobodyThere, UntilAClientSpeaksAndAfterItIsLost) {
  Bench bench;
  EXPECT_TRUE(bench.last.nobody_there);
  bench.run_until(1s);
  EXPECT_TRUE(bench.last.nobody_there);
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  EXPECT_FALSE(bench.last.nobody_there);
  bench.run_until(3999ms);
  EXPECT_FALSE(bench.last.nobody_there);
  bench.run_until(4s);
  EXPECT_TRUE(bench.last.nobody_there);
  bench.run_until(10s);
  EXPECT_TRUE(bench.last.nobody_there);
  bench.command(to_head<StatusRequest>());
  EXPECT_FALSE(bench.last.nobody_there);
  bench.command(to_head<Reboot>());
  EXPECT_TRUE(bench.last.nobody_there);
}

TEST(NobodyThere, IsNotSaidByTheTransport) {
  Bench bench;
  bench.command(to_head<StatusRequest>());
  bench.step(ClientGone{{0, {client_address, client_port}, head_address}});
  EXPECT_FALSE(bench.last.nobody_there) << "a client is whoever sent the last command";
  EXPECT_EQ(bench.device.client(), client_address);
}

TEST(Cancelled, NamesTheJobThatNobodyWantsUntilItIsAnswered) {
  Bench bench;
  bench.renderer_answers = false;
  bench.command(ping_of(100));
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  bench.run_until(2900ms);
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  bench.run_until(3s);  // the client is lost
  EXPECT_EQ(bench.last.cancelled, 0U);
  bench.run_until(5s);
  EXPECT_EQ(bench.last.cancelled, 0U) << "as long as it is out";
  bench.command(ping_of(100));
  EXPECT_EQ(bench.last.cancelled, 0U);
  EXPECT_FALSE(bench.last.render) << "at most one job is out";
  bench.step(PingNotRendered{0});
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  ASSERT_TRUE(bench.last.render);
  EXPECT_EQ(bench.last.render->number, 1U);
  EXPECT_EQ(bench.device.counters().pings_cancelled, 1U);
  EXPECT_EQ(bench.device.counters().pings_failed, 0U);
}

TEST(Cancelled, BySettingsThatComeBeforeItsTime) {
  DeviceConfig device = example_config();
  device.render_lead = 50ms;
  Bench bench(device);
  bench.renderer_answers = false;
  bench.command(ping_of(100, RunMode::continuous, 200ms));
  bench.answer(test_image(bench.jobs.at(0)));
  bench.run_until(160ms);
  ASSERT_EQ(bench.jobs.size(), 2U);
  bench.command(ping_of(300));
  EXPECT_EQ(bench.last.cancelled, 1U);
}

TEST(Answers, GoToThePortOfTheConfiguration) {
  DeviceConfig config = example_config();
  config.client_port = 40'001;
  Bench bench(config);
  bench.step(
      BytesReceived{{0, {client_address, 55'555}, head_address}, SharedBytes(encode(Command{ping_of(32)}))});
  bench.run_for(100ms);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 1U);
  bench.command(to_head<StatusRequest>());
  ASSERT_FALSE(bench.last.send.empty());
  for (const Outgoing& answer : bench.last.send) {
    EXPECT_EQ(answer.to, Outgoing::To::peer);
    EXPECT_EQ(answer.peer, (Peer{0, {client_address, 40'001}, head_address}));
  }
}

TEST(Jobs, SayWhatTheClientHasSet) {
  Bench bench;
  PingConfig config = ping_of(2411);
  config.range_compression = 1;
  config.main_gain = 0x83E8;
  config.spreading = 67;
  bench.command(config);
  EXPECT_EQ(bench.jobs.at(0).settings, (std::vector<Setting>{{"range", "20.00m"},
                                                             {"lines", "1205"},
                                                             {"compression", "x2"},
                                                             {"gain", "-5.5dB"},
                                                             {"sound_speed", "1500.0m/s"},
                                                             {"bits", "8"}}));
}

TEST(Jobs, SayWhenTheClientOnlyListens) {
  Bench bench;
  PingConfig config = ping_of(64);
  config.ext_mode = 0x0200;
  config.tx_length = 0;
  bench.command(config);
  const std::vector<Setting>& settings = bench.jobs.at(0).settings;
  ASSERT_EQ(settings.size(), 7U);
  EXPECT_EQ(settings[5], (Setting{"bits", "16"}));
  EXPECT_EQ(settings[6], (Setting{"transmit", "off"}));
}

TEST(Jobs, HaveTheTimeOfTheHead) {
  Bench bench;
  bench.command(to_head<Reboot>());
  bench.run_until(7s);
  bench.command(ping_of(9042));
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.jobs[0].transmit_time, 7s);
  EXPECT_EQ(bench.jobs[0].transmit_us, 2'000'000U);
  EXPECT_EQ(bench.jobs[0].listening_time, 99'997'789ns) << "9042 lines at 90422 Hz, rounded up";
}

TEST(Jobs, SayHowSoonTheNextIsAskedFor) {
  Bench bench;
  bench.command(ping_of(9042));
  bench.run_until(1s);
  bench.command(ping_of(482, RunMode::continuous, 250ms));
  bench.run_until(2s);
  bench.command(ping_of(482, RunMode::continuous, 1ms));
  bench.run_until(3s);
  EXPECT_EQ(bench.jobs.at(0).period, 99'997'789ns) << "one ping after the other: when its echoes are back";
  EXPECT_EQ(bench.jobs.at(1).period, 250ms);
  EXPECT_EQ(bench.jobs.back().period, 33'300us) << "the head's shortest (8.4)";
}

std::optional<Counter> counter(const Device& device, std::string_view name) {
  const std::vector<Counter> counts = device.counts();
  const auto found = std::ranges::find(counts, name, &Counter::name);
  return found == counts.end() ? std::nullopt : std::optional(*found);
}

TEST(Counts, AreThoseOfTheHead) {
  Bench bench;
  bench.command(ping_of(100));
  bench.run_for(100ms);
  bench.command(retry_of(RetryKind::lines, 3, 4));
  bench.command(retry_of(RetryKind::tail));
  bench.run_for(10ms);
  StatusRequest other;
  other.header.sonar_id = 602;
  bench.command(other);
  bench.command(StatusRequest{});
  EXPECT_EQ(counter(bench.device, "pings_sent").value().value, 1U);
  EXPECT_EQ(counter(bench.device, "lines_sent").value().value, 100U);
  EXPECT_EQ(counter(bench.device, "commands").value().value, 3U);
  EXPECT_EQ(counter(bench.device, "lines_resent").value().value, 4U);
  EXPECT_EQ(counter(bench.device, "lines_resent").value().shown, Counter::Shown::often);
  EXPECT_EQ(counter(bench.device, "tails_resent").value().value, 1U);
  EXPECT_EQ(counter(bench.device, "tails_resent").value().shown, Counter::Shown::often);
  EXPECT_EQ(counter(bench.device, "wrong_id").value().value, 2U);
  EXPECT_EQ(counter(bench.device, "wrong_id").value().shown, Counter::Shown::warns);
  EXPECT_EQ(counter(bench.device, "wrong_id").value().warning,
            "{} commands were for another sonar ID: the last one for 0, but this head has 601 (sonar_id)");
}

TEST(Counts, OfValuesThatTheHeadClampsAreFaultsOfTheClientAndWarnedOfOnce) {
  Bench bench;
  const PingConfig good = ping_of(100);
  bench.command(good);
  EXPECT_EQ(counter(bench.device, "out_of_range").value().value, 0U);
  PingConfig config = good;
  config.end_range = 31;
  bench.command(config);
  EXPECT_EQ(texts(bench.last.notices, Notice::Level::warning),
            Texts{"the client's end_range 31 is out of range: the head uses 32 to 20000"});
  config.end_range = 20'001;
  bench.command(config);
  EXPECT_EQ(texts(bench.last.notices, Notice::Level::warning), Texts{});
  config = good;
  config.velocimeter_mode = 1;
  config.sound_speed = 13'999;
  bench.command(config);
  EXPECT_EQ(texts(bench.last.notices, Notice::Level::warning),
            Texts{"the client's sound_speed 13999 is out of range: the head uses 14000 to 15888"});
  config.velocimeter_mode = 0;
  bench.command(config);
  EXPECT_EQ(counter(bench.device, "out_of_range").value().value, 3U) << "the last one is not used";
  EXPECT_EQ(counter(bench.device, "out_of_range").value().fault, Counter::Fault::of_client);
}

TEST(Counts, OfUnknownTypesAreFaultsOfTheClientThatWarn) {
  Bench bench;
  std::vector<std::uint8_t> message = encode(Command{to_head<StatusRequest>()});
  message[0] = 0xC0;
  bench.receive({0, {client_address, 52901}, 0}, message);
  EXPECT_EQ(counter(bench.device, "unknown_type").value().value, 1U);
  EXPECT_EQ(counter(bench.device, "unknown_type").value().fault, Counter::Fault::of_client);
  EXPECT_EQ(counter(bench.device, "unknown_type").value().shown, Counter::Shown::warns);
}

TEST(Progress, GrowsWithWhatIsSentAndWithWhatIsAskedForAgain) {
  Bench bench;
  bench.command(ping_of(100));
  EXPECT_EQ(bench.device.progress().sent, 0U) << "its tail is not out";
  bench.run_for(100ms);
  EXPECT_EQ(bench.device.progress().sent, 1U);
  EXPECT_EQ(bench.device.progress().ended, 1U);
  EXPECT_EQ(bench.device.progress().messages, 100U);
  bench.command(retry_of(RetryKind::lines, 3, 4));
  bench.run_for(100ms);
  EXPECT_EQ(bench.device.progress().sent, 1U);
  EXPECT_EQ(bench.device.progress().messages, 105U) << "a request and four lines";
}

TEST(Progress, EndsPingsThatFailAndThatAreCancelled) {
  Bench bench;
  bench.renderer_fails = true;
  bench.command(ping_of(100));
  bench.run_for(100ms);
  EXPECT_EQ(bench.device.progress().ended, 1U);
  bench.renderer_answers = false;
  bench.command(ping_of(100));
  EXPECT_EQ(bench.device.progress().ended, 1U);
  bench.command(to_head<Reboot>());
  EXPECT_EQ(bench.device.progress().ended, 2U);
  EXPECT_EQ(bench.device.progress().sent, 0U);
}

}  // namespace
}  // namespace sonard::gemini
