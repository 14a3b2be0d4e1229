// SPDX-License-Identifier: Apache-2.0
// A log played back and recorded again is the same log: what a head sends for a recorded image, put together
// as a surface does and written down as the recorder writes it, is that image.
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
#include "protocol/glf/codec.hpp"
#include "server/logs/glf_recording.hpp"
#include "server/recording/gemini_glf.hpp"
#include "server/replay/log_playback.hpp"
#include "tests/unit/logs/temporary_log.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t sonar_id = 513;
constexpr gemini::Ipv4 surface = 0x7F000001;

/// A ping as a head with these settings sends it, every sample different from its neighbours.
GeminiPing ping(int number, int compression_log2, double sound_speed_mps, bool told) {
  GeminiPing ping;
  ping.head.header.sonar_id = sonar_id;
  ping.head.range_compression = static_cast<std::uint8_t>(compression_log2);
  ping.head.end_range = static_cast<std::uint16_t>(((40 + number) << compression_log2));
  ping.head.sound_speed_used =
      static_cast<std::uint16_t>((told ? 0x8000 : 0) | std::lround(10.0 * sound_speed_mps));
  ping.pixels.resize(static_cast<std::size_t>(ping.head.line_count()) * 256);
  for (std::size_t i = 0; i < ping.pixels.size(); ++i) {
    ping.pixels[i] = static_cast<std::uint8_t>(i * 37 + i / 256 * 11 + static_cast<std::size_t>(number));
  }
  ping.transmit_unix_ns = 1'795'184'553'000'000'000 + 100'000'000LL * number;
  ping.gain_percent = 30.0 + number;
  return ping;
}

std::vector<glf::ImageRecord> images() {
  std::vector<glf::ImageRecord> images;
  int number = 0;
  for (const int compression_log2 : {0, 1, 2, 3, 4}) {
    for (const double sound_speed_mps : {1400.0, 1480.5, 1588.8}) {
      images.push_back(to_glf_image(ping(number, compression_log2, sound_speed_mps, number % 2 == 0), {}));
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

/// A continuous client that asks for something else altogether.
std::vector<std::uint8_t> request() {
  gemini::PingConfig config;
  config.header.sonar_id = sonar_id;
  config.run_mode = 1;
  config.ext_mode = 0x0200;
  config.end_range = 3000;
  config.rle_threshold = 40;
  config.sound_speed = 15000;
  config.velocimeter_mode = 1;
  return gemini::encode(gemini::Command{config});
}

struct Received {
  gemini::PingHead head;
  std::vector<std::uint8_t> pixels;
  bool whole = false;
};

/// Plays all images on a head of its own, in steps of virtual time; what arrives.
std::vector<Received> played(const GlfRecording& recording) {
  gemini::DeviceConfig config;
  config.sonar_id = sonar_id;
  config.alternate_address = 0x7F000002;
  config.min_ping_period = 1ms;
  config.plays_back = true;
  gemini::Device device(config, 0ns);
  LogPlayback playback({{"bow", &recording.heads().at(0)}}, {.as_asked = true}, 0ns);
  device.on_datagram(0ns, surface, 0, request());
  std::vector<Received> pings;
  for (TimePoint now = 0ns; !playback.finished(now) && now < 60s; now += 1ms) {
    if (now % 1s == 0s) {
      device.on_datagram(now, surface, 0,
                         gemini::encode(gemini::Command{gemini::StatusRequest{{.sonar_id = sonar_id}}}));
    }
    playback.progress(0, now, device.counters());
    device.offer(playback.next_ping(0, now));
    device.advance(now);
    if (const auto job = device.take_job()) {
      playback.started(0, *job);
      const RecordedImage& image = recording.heads()[0].images.at(*job->record);
      device.on_image(now, {job->ping_number, recording.pixels(image), {}});
    }
    for (const gemini::Outgoing& outgoing : device.take_outgoing()) {
      const auto report = gemini::decode_report(outgoing.bytes);
      if (const auto* head = std::get_if<gemini::PingHead>(&*report)) {
        pings.push_back({*head, {}, false});
      } else if (const auto* line = std::get_if<gemini::PingLine>(&*report)) {
        pings.back().pixels.insert(pings.back().pixels.end(), line->data.begin(), line->data.end());
      } else if (std::holds_alternative<gemini::PingTail>(*report)) {
        pings.back().whole = true;
      }
    }
  }
  return pings;
}

TEST(RecordingAgain, gives_the_same_images) {
  const std::vector<glf::ImageRecord> written = images();
  const test::TemporaryLog log(".dat", dat_of(written));
  const LogFile file(log.path());
  const GlfRecording recording(file);
  const std::vector<Received> received = played(recording);
  ASSERT_EQ(received.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    ASSERT_TRUE(received[i].whole) << "image " << i;
    GeminiPing again;
    again.head = received[i].head;
    again.pixels = received[i].pixels;
    again.transmit_unix_ns = recording.heads()[0].images[i].time_ns;
    again.gain_percent = recording.heads()[0].images[i].settings.gain_percent;
    glf::ImageRecord image = to_glf_image(std::move(again), {});
    EXPECT_NEAR(image.transmit_time_s, written[i].transmit_time_s, 1e-6);
    image.transmit_time_s = image.origin.time_s = written[i].origin.time_s;
    EXPECT_EQ(image, written[i]) << "image " << i;
  }
}

}  // namespace
}  // namespace sonard::server
