// SPDX-License-Identifier: Apache-2.0
// A log that is played back and recorded again must be equal. The images come from the datagrams of a head,
// joined as in a client, and from the records of the head itself. Both are written as by the recorder.
#include <cmath>
#include <deque>
#include <numeric>

#include <gtest/gtest.h>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
#include "protocol/gemini/recorded_form.hpp"
#include "protocol/glf/codec.hpp"
#include "server/logs/glf_log_reader.hpp"
#include "server/recording/glf_records.hpp"
#include "server/replay/log_playback.hpp"
#include "tests/unit/server/logs/temporary_log.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t sonar_id = 513;
constexpr Ipv4 client = 0x7F000001;
constexpr GlfLogOrigin origin{.device_id = sonar_id};

std::int64_t transmit_unix_ns(int number) {
  return 1'795'184'553'000'000'000 + 100'000'000LL * number;
}

/// A ping as a head with these settings sends it. Every sample differs from its neighbours.
PingRecord ping(int number, int compression_log2, double sound_speed_mps, bool told) {
  gemini::PingHead head;
  head.header.sonar_id = sonar_id;
  head.ext_mode = gemini::ext_bits::eight_bit;
  head.range_compression = static_cast<std::uint8_t>(compression_log2);
  head.end_range = static_cast<std::uint16_t>(((40 + number) << compression_log2));
  head.sound_speed_used =
      static_cast<std::uint16_t>((told ? 0x8000 : 0) | std::lround(10.0 * sound_speed_mps));
  PingImage image;
  image.u8.resize(static_cast<std::size_t>(head.line_count()) * 256);
  for (std::size_t i = 0; i < image.u8.size(); ++i) {
    image.u8[i] = static_cast<std::uint8_t>(i * 37 + i / 256 * 11 + static_cast<std::size_t>(number));
  }
  PingRecord ping = gemini::record_of(head, image);
  ping.settings.gain_percent = 30.0 + number;
  return ping;
}

std::vector<glf::ImageRecord> images() {
  std::vector<glf::ImageRecord> images;
  int number = 0;
  for (const int compression_log2 : {0, 1, 2, 3, 4}) {
    for (const double sound_speed_mps : {1400.0, 1480.5, 1588.8}) {
      images.push_back(glf_image(ping(number, compression_log2, sound_speed_mps, number % 2 == 0),
                                 transmit_unix_ns(number), origin));
      ++number;
    }
  }
  return images;
}

std::vector<std::uint8_t> dat_of(const std::vector<glf::ImageRecord>& images) {
  std::vector<std::uint8_t> dat;
  for (const glf::ImageRecord& image : images) {
    const auto record = glf::encode(image);
    dat.insert(dat.end(), record.begin(), record.end());
  }
  dat.insert(dat.end(), {0xDE, 0xDE});
  return dat;
}

BytesReceived from_client(const gemini::Command& command) {
  return {{0, {client, gemini::client_port}, 0}, SharedBytes(gemini::encode(command))};
}

/// The request of a continuous client with other settings than the log.
BytesReceived request() {
  gemini::PingConfig config;
  config.header.sonar_id = sonar_id;
  config.run_mode = 1;
  config.ext_mode = 0x0200;
  config.end_range = 3000;
  config.rle_threshold = 40;
  config.sound_speed = 15000;
  config.velocimeter_mode = 1;
  return from_client(config);
}

struct Received {
  gemini::PingHead head;
  PingImage image;
  bool whole = false;
};

struct Played {
  std::vector<Received> received;
  std::vector<PingRecord> recorded;
};

void receive(std::vector<Received>& pings, const Outgoing& message) {
  const auto report = gemini::decode_report(message.bytes);
  if (const auto* head = std::get_if<gemini::PingHead>(&*report)) {
    pings.push_back({*head, {}, false});
  } else if (const auto* line = std::get_if<gemini::PingLine>(&*report)) {
    std::vector<std::uint8_t>& samples = pings.back().image.u8;
    samples.insert(samples.end(), line->data.begin(), line->data.end());
  } else if (std::holds_alternative<gemini::PingTail>(*report)) {
    pings.back().whole = true;
  }
}

/// Plays all images on a new head, in virtual time. Returns the received and the recorded pings.
Played played(const GlfLogReader& recording) {
  gemini::DeviceConfig config;
  config.sonar_id = sonar_id;
  config.alternate_address = 0x7F000002;
  config.min_ping_period = 1ms;
  config.plays_back = true;
  gemini::Device device(config, 0ns);
  LogPlayback playback({{"bow", &recording.heads().at(0)}}, {.as_asked = true}, 0ns);
  Played played;
  std::deque<Event> events{request()};
  for (TimePoint now = 0ns; !playback.finished(now) && now < 60s; now += 1ms) {
    if (now % 1s == 0s) {
      events.emplace_back(from_client(gemini::StatusRequest{{.sonar_id = sonar_id}}));
    }
    events.emplace_back(PingFed{playback.next_ping(0, now)});
    for (; !events.empty(); events.pop_front()) {
      const Actions actions = device.step(now, events.front());
      if (actions.record) {
        played.recorded.push_back(*actions.record);
      }
      for (const Outgoing& message : actions.send) {
        receive(played.received, message);
      }
      playback.progress(0, now, device.progress());
      if (actions.render) {
        playback.started(0, *actions.render);
        const LoggedPing& image = recording.heads()[0].pings.at(*actions.render->record);
        events.emplace_back(PingRendered{{actions.render->number, recording.samples(image), {}}});
      }
    }
  }
  return played;
}

/// Compares two images except for the exact time, which a .glf rounds.
void expect_same(glf::ImageRecord again, const glf::ImageRecord& written) {
  EXPECT_NEAR(again.transmit_time_s, written.transmit_time_s, 1e-6);
  again.transmit_time_s = again.origin.time_s = written.origin.time_s;
  EXPECT_EQ(again, written);
}

TEST(RecordingAgain, GivesTheSameImages) {
  const std::vector<glf::ImageRecord> written = images();
  const test::TemporaryLog log(".dat", dat_of(written));
  const LogFile file(log.path());
  const GlfLogReader recording(file);
  const auto [received, recorded] = played(recording);
  ASSERT_EQ(received.size(), written.size());
  ASSERT_EQ(recorded.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    SCOPED_TRACE(i);
    ASSERT_TRUE(received[i].whole);
    const LoggedPing& logged = recording.heads()[0].pings[i];
    PingRecord arrived = gemini::record_of(received[i].head, received[i].image);
    arrived.settings.gain_percent = logged.settings.gain_percent;
    expect_same(glf_image(std::move(arrived), logged.time_ns, origin), written[i]);
    expect_same(glf_image(recorded[i], logged.time_ns, origin), written[i]);
  }
}

}  // namespace
}  // namespace sonard::server
