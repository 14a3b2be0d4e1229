// SPDX-License-Identifier: Apache-2.0
// A head in virtual time: shots, their messages and destinations (acceptance 4 to 10).
#include "protocol/sonar3d15/device.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "protocol/sonar3d15/recording.hpp"
#include "tests/unit/protocol/sonar3d15/device/bench.hpp"

namespace sonard::sonar3d15::testing {
namespace {

using namespace std::chrono_literals;

void switch_on(Bench& bench) {
  ASSERT_EQ(bench.post("acoustics/enabled", "true"), 204);
}

TEST(Device, AcousticsAreOffAtStart) {
  Bench bench;
  bench.run_for(10s);
  EXPECT_TRUE(bench.jobs.empty());
  EXPECT_TRUE(bench.messages.empty());
  EXPECT_TRUE(bench.last.nobody_there);
}

TEST(Device, BothImagesOfAShotHaveOneHeaderAndTheRangeIsFirst) {
  DeviceConfig config = small();
  config.utc_offset = 1'767'225'600s;
  config.first_sequence = 0xFFFF'FFFE;
  Bench bench(config);
  switch_on(bench);
  bench.run_for(999ms);
  ASSERT_EQ(bench.messages.size(), 10U);  // 5 shots a second
  for (std::size_t shot = 0; shot < 5; ++shot) {
    const auto* const range = std::get_if<RangeImage>(&bench.messages[2 * shot]);
    const auto* const signal = std::get_if<BitmapImageGreyscale8>(&bench.messages[2 * shot + 1]);
    ASSERT_TRUE(range != nullptr && signal != nullptr);
    EXPECT_EQ(range->header().SerializeAsString(), signal->header().SerializeAsString());
    EXPECT_EQ(range->header().sequence_id(), static_cast<std::uint32_t>(0xFFFF'FFFE + shot));
    EXPECT_EQ(range->header().timestamp().seconds(), 1'767'225'600);
    EXPECT_EQ(range->header().timestamp().nanos(), static_cast<int>(200'000'000 * shot));
    EXPECT_EQ(range->frequency(), 5U);
    EXPECT_EQ(signal->frequency(), 5U);
    EXPECT_EQ(signal->type(), 0);
    ASSERT_EQ(range->image_pixel_data_size(), 32);
    int echoes = 0;
    for (int pixel = 0; pixel < 32; ++pixel) {
      const bool empty = signal->image_pixel_data()[static_cast<std::size_t>(pixel)] == '\0';
      EXPECT_EQ(range->image_pixel_data(pixel) == 0, empty);
      echoes += empty ? 0 : 1;
    }
    EXPECT_TRUE(echoes > 16 && echoes < 32) << echoes;
  }
}

TEST(Device, AShotIsSentAfterItsLatency) {
  Bench bench;
  switch_on(bench);
  bench.run_for(50ms - 1ns);
  EXPECT_TRUE(bench.messages.empty());
  bench.run_for(1ns);
  EXPECT_EQ(bench.messages.size(), 2U);
}

TEST(Device, DirectionsKeepTheirPlaces) {
  Bench bench;
  bench.render = [](const PingJob& job) {
    PingImage image{job.number, {}, {}};
    image.directions = {8, 4, std::vector<float>(32), std::vector<float>(32)};
    image.directions.range_m[6] = 5.0F;  // lowest row, to starboard
    image.directions.intensity[6] = 1.0F;
    return image;
  };
  switch_on(bench);
  bench.run_for(100ms);
  const RangeImage image = bench.images<RangeImage>().at(0);
  for (int pixel = 0; pixel < 32; ++pixel) {
    EXPECT_EQ(image.image_pixel_data(pixel) != 0, pixel == 6) << pixel;
  }
}

TEST(Device, ImagesGoWhereAClientSendsThem) {
  Bench bench;
  switch_on(bench);
  const auto destination = [&]() -> std::optional<Endpoint> {
    const std::size_t before = bench.destinations.size();
    bench.run_for(200ms);
    EXPECT_TRUE(bench.destinations.size() == before || bench.destinations.size() == before + 2);
    return bench.destinations.size() > before ? std::optional(bench.destinations.back()) : std::nullopt;
  };
  EXPECT_EQ(destination(), multicast_group);
  EXPECT_EQ(
      bench.post("udp",
                 R"({"mode":"unicast","unicast_destination_ip":"10.0.0.7","unicast_destination_port":99})"),
      204);
  EXPECT_EQ(destination(), (Endpoint{0x0A000007, 99}));
  EXPECT_EQ(
      bench.post("udp", R"({"mode":"disabled","unicast_destination_ip":"","unicast_destination_port":0})"),
      204);
  EXPECT_EQ(destination(), std::nullopt);
  EXPECT_EQ(
      bench.post("udp", R"({"mode":"multicast","unicast_destination_ip":"","unicast_destination_port":0})"),
      204);
  EXPECT_EQ(destination(), multicast_group);
  for (const Outgoing& message : bench.last.send) {
    EXPECT_EQ(message.peer.channel, Device::image_channel);
  }
}

TEST(Device, AcousticsOffSilencesEverythingAndNumbersContinue) {
  Bench bench;
  ASSERT_EQ(bench.post("output/imu-batch/enabled", "true"), 204);
  switch_on(bench);
  bench.run_for(410ms);  // the third shot is under way
  ASSERT_EQ(bench.post("acoustics/enabled", "false"), 204);
  bench.messages.clear();
  bench.run_for(5s);
  EXPECT_TRUE(bench.messages.empty());
  EXPECT_EQ(bench.head.counters().pings_cancelled, 1U);
  switch_on(bench);
  bench.run_for(100ms);
  ASSERT_EQ(bench.images<RangeImage>().size(), 1U);
  EXPECT_EQ(bench.images<RangeImage>()[0].header().sequence_id(), 2U);
}

TEST(Device, ABatchFollowsEachShotIfItIsEnabled) {
  Bench bench;
  switch_on(bench);
  bench.run_for(390ms);
  EXPECT_TRUE(bench.images<ImuBatch>().empty());
  ASSERT_EQ(bench.post("output/imu-batch/enabled", "true"), 204);
  bench.run_for(400ms);
  const auto batches = bench.images<ImuBatch>();
  ASSERT_EQ(batches.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<ImuBatch>(bench.messages.back()));
  EXPECT_EQ(batches[0].batch_sequence_id(), 0U);
  EXPECT_EQ(batches[1].batch_sequence_id(), 1U);
  EXPECT_EQ(batches[1].samples(), 20U);
  EXPECT_EQ(batches[1].timestamps(19).nanos(), 600'000'000);
  ASSERT_EQ(bench.post("acoustics/mode", "\"high-frequency\""), 204);
  bench.run_for(1s);
  EXPECT_EQ(bench.images<ImuBatch>().back().samples(), 5U);
}

TEST(Device, BatchesHaveAsManySamplesAsTheConfigurationSays) {
  DeviceConfig config = small();
  config.imu_batch_samples = 7;
  Bench bench(config);
  ASSERT_EQ(bench.post("output/imu-batch/enabled", "true"), 204);
  switch_on(bench);
  bench.run_for(450ms);  // three shots of 20 samples
  const auto batches = bench.images<ImuBatch>();
  ASSERT_EQ(batches.size(), 8U);
  std::chrono::nanoseconds last{};
  for (std::uint32_t i = 0; i < 8; ++i) {
    EXPECT_EQ(batches[i].batch_sequence_id(), i);
    EXPECT_EQ(batches[i].samples(), 7U);
    EXPECT_EQ(batches[i].specific_force_size(), 21);
    EXPECT_EQ(batches[i].rate_of_turn_size(), 21);
    ASSERT_EQ(batches[i].timestamps_size(), 7);
    for (const auto& stamp : batches[i].timestamps()) {
      const auto time = std::chrono::seconds{stamp.seconds()} + std::chrono::nanoseconds{stamp.nanos()};
      EXPECT_TRUE(i == 0 || time - last == 10ms);
      last = time;
    }
  }
}

TEST(Device, AShadedImageFollowsTheSignalsIfTheConfigurationSaysSo) {
  DeviceConfig config = small();
  config.sends_shaded = true;
  Bench bench(config);
  switch_on(bench);
  bench.run_for(100ms);
  ASSERT_EQ(bench.messages.size(), 3U);
  const auto images = bench.images<BitmapImageGreyscale8>();
  ASSERT_EQ(images.size(), 2U);
  EXPECT_EQ(images[0].type(), waterlinked::sonar::protocol::SIGNAL_STRENGTH_IMAGE);
  EXPECT_EQ(images[1].type(), waterlinked::sonar::protocol::SHADED_IMAGE);
  EXPECT_EQ(images[1].header().sequence_id(), images[0].header().sequence_id());
  for (std::size_t i = 0; i < 32; ++i) {
    EXPECT_EQ(images[0].image_pixel_data()[i] == 0, images[1].image_pixel_data()[i] == 0);
  }
}

TEST(Device, ANewSpeedOfSoundTakesTheTimeOfTheConfiguration) {
  DeviceConfig config = small();
  config.speed_change_time = 1s;
  Bench bench(config);
  switch_on(bench);
  EXPECT_EQ(bench.post("acoustics/speed_of_sound", "1450"), 204);
  EXPECT_EQ(bench.get("acoustics/speed_of_sound"), "1450");
  bench.run_for(1300ms);
  const auto images = bench.images<RangeImage>();
  ASSERT_EQ(images.size(), 7U);
  EXPECT_EQ(images[4].speed_of_sound(), 1491.0F);
  EXPECT_EQ(images[5].speed_of_sound(), 1450.0F);
}

TEST(Device, ASettingTakesEffectWithTheNextShot) {
  Bench bench;
  switch_on(bench);
  bench.run_for(40ms);  // the first shot is under way
  EXPECT_EQ(bench.post("acoustics/mode", "\"high-frequency\""), 204);
  EXPECT_EQ(bench.post("acoustics/range", R"({"min": 1.0, "max": 4.5})"), 204);
  EXPECT_EQ(bench.post("acoustics/speed_of_sound", "1450"), 204);
  bench.run_for(160ms + 1s);
  const auto images = bench.images<RangeImage>();
  EXPECT_EQ(images.size(), 1U + 20U);
  EXPECT_EQ(images[0].fov_horizontal(), 90.0F);
  EXPECT_EQ(images[0].range(), 15.0F);
  EXPECT_EQ(images[0].speed_of_sound(), 1491.0F);
  EXPECT_EQ(images[1].fov_horizontal(), 40.0F);
  EXPECT_EQ(images[1].range(), 4.5F);
  EXPECT_EQ(images[1].speed_of_sound(), 1450.0F);
  EXPECT_EQ(images[1].frequency(), 20U);
  for (const std::uint32_t code : images[1].image_pixel_data()) {
    const double range_m = code * 50.0 / 65536;
    EXPECT_TRUE(code == 0 || (range_m > 0.99 && range_m <= 4.5)) << range_m;
  }
}

TEST(Device, ThePacketsAreThoseOfTheRelease) {
  const auto id = [](Release release, std::optional<PacketId> packets) {
    DeviceConfig config = small();
    config.release = release;
    config.packets = packets;
    Bench bench(config);
    switch_on(bench);
    bench.run_for(100ms);
    return std::string(bench.recording.begin(), bench.recording.begin() + 4);
  };
  EXPECT_EQ(id({1, 8, 0}, {}), "RIP2");
  EXPECT_EQ(id({1, 6, 0}, {}), "RIP2");
  EXPECT_EQ(id({1, 5, 1}, {}), "RIP1");
  EXPECT_EQ(id({1, 8, 0}, PacketId::rip1), "RIP1");
}

TEST(Device, DatagramsOneAfterAnotherAreARecording) {
  DeviceConfig config;
  Bench bench(config);  // of the usual size
  switch_on(bench);
  bench.run_for(1s);
  std::size_t packets = 0;
  EXPECT_TRUE(for_each_packet(bench.recording, [&](std::span<const std::uint8_t>) { ++packets; }).empty());
  EXPECT_EQ(packets, 10U);
  std::vector<std::uint8_t> recorded;
  for (const PingRecord& record : bench.records) {
    recorded.insert(recorded.end(), record.wire.begin(), record.wire.end());
  }
  EXPECT_EQ(recorded, bench.recording);
}

TEST(Device, AShotWithoutAnImageOrWithAnotherSizeIsNotSent) {
  Bench bench;
  bench.render = [](const PingJob& job) { return PingImage{job.number, std::vector<std::uint8_t>(32), {}}; };
  switch_on(bench);
  bench.run_for(300ms);
  EXPECT_EQ(bench.head.counters().pings_failed, 2U);
  EXPECT_TRUE(bench.messages.empty());
}

TEST(Device, HttpDoesNotDelayShots) {
  Bench bench;
  switch_on(bench);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(bench.post("acoustics/speed_of_sound", i % 2 == 0 ? "1500" : "oops"), i % 2 == 0 ? 204 : 400);
    bench.run_for(1ms);
  }
  EXPECT_EQ(bench.images<RangeImage>().size(), 5U);
}

TEST(Device, TwoClientsShareTheSettings) {
  Bench bench;
  const Peer other{Device::control_channel, {0xC0A80206, 40000}, 0};
  bench.step(ClientCame{other});
  const auto half = encode(Request{"POST", integration + "acoustics/enabled", "true"});
  const Actions first =
      bench.head.step(bench.now, BytesReceived{other, SharedBytes({half.begin(), half.end() - 1})});
  EXPECT_TRUE(first.send.empty());
  EXPECT_EQ(bench.get("acoustics/enabled"), "false");  // not the rest of the other client's body
  const Actions second = bench.head.step(bench.now, BytesReceived{other, SharedBytes({half.back()})});
  ASSERT_EQ(second.send.size(), 1U);
  EXPECT_EQ(second.send[0].peer, other);
  EXPECT_EQ(bench.get("acoustics/enabled"), "true");
}

TEST(Device, AClientThatEndsOrBreaksItsConnectionIsDisconnectedAfterTheReply) {
  Bench bench;
  bench.receive(bench.client, encode(Request{"GET", integration + "udp", "", false}));
  EXPECT_EQ(bench.replies.back().status, 200);
  EXPECT_EQ(bench.last.disconnect, std::vector<Peer>{bench.client});
  bench.receive(bench.client, encode(Request{"GET", integration + "udp", ""}));
  EXPECT_TRUE(bench.last.send.empty());
  bench.step(ClientGone{bench.client});
  bench.step(ClientCame{bench.client});
  bench.receive(bench.client, {'?', '\r', '\n', '\r', '\n'});
  EXPECT_EQ(bench.replies.back().status, 400);
  EXPECT_EQ(bench.last.disconnect, std::vector<Peer>{bench.client});
}

TEST(Device, ARecordedShotIsSentWithANewHeader) {
  Bench source;
  switch_on(source);
  source.run_for(100ms);
  const PingRecord& record = source.records.at(0);

  DeviceConfig config = small();
  config.plays_back = true;
  config.first_sequence = 40;
  Bench player(config);
  player.render = [&](const PingJob& job) { return PingImage{job.number, record.samples, {}}; };
  EXPECT_EQ(player.post("acoustics/range", R"({"min":0,"max":5})"), 204);
  switch_on(player);
  ReplayedPing fed;
  fed.settings = record.settings;
  fed.wire = record.wire;
  player.step(PingFed{fed});
  player.run_for(300ms);
  ASSERT_EQ(player.jobs.size(), 1U);
  EXPECT_FALSE(player.jobs[0].directions.any());
  ASSERT_EQ(player.jobs[0].differences.size(), 1U);
  EXPECT_EQ(player.jobs[0].differences[0].text, "range 5.00 m requested, 15.00 m sent");
  RangeImage sent = player.images<RangeImage>().at(0), recorded = source.images<RangeImage>().at(0);
  EXPECT_EQ(sent.header().sequence_id(), 40U);
  sent.clear_header();
  recorded.clear_header();
  EXPECT_EQ(sent.SerializeAsString(), recorded.SerializeAsString());
  EXPECT_EQ(player.images<BitmapImageGreyscale8>().at(0).image_pixel_data(),
            source.images<BitmapImageGreyscale8>().at(0).image_pixel_data());
  EXPECT_EQ(player.records.at(0).samples, record.samples);
}

}  // namespace
}  // namespace sonard::sonar3d15::testing
