// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/recording_cost.hpp"

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "protocol/gemini/device_config.hpp"
#include "protocol/gemini/encoded_ping.hpp"
#include "protocol/gemini/recorded_form.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/recording/glf_device.hpp"
#include "server/recording/head_recording.hpp"
#include "server/recording/log_set.hpp"
#include "server/recording/recorder.hpp"
#include "tests/bench/timing.hpp"
#include "tests/scenes/scenes.hpp"

namespace sonard::bench {
namespace {

namespace fs = std::filesystem;
using server::TimePoint;

constexpr int lines = 1000;
constexpr std::chrono::milliseconds ping_interval{60};
constexpr Repetition repetition{20, 201, 0.5};
constexpr const char* scene_name = "recording";

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "sonard-bench-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error(name + ": cannot be made");
    }
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// A ping as a head sends and records it. How well it compresses decides the cost of a .glf.
struct Ping {
  gemini::EncodedPing encoded;
  PingRecord record;
};
Ping make_ping() {
  const test::Scene scene = test::make_scene("plane");
  render::SonarRenderer renderer(scene.world, {render::EngineKind::cpu});
  render::PingSamples samples = renderer.render_ping(scene.request());
  gemini::PingHead head;
  head.header.sonar_id = 513;
  head.ext_mode = gemini::ext_bits::eight_bit;
  head.end_range = lines;
  head.sound_speed_used = 0x8000 | 15'000;
  const PingImage image{0, std::move(samples.u8), {}};
  return {{head, 0, image}, gemini::record_of(head, image)};
}

/// All events of one ping that a head sends to the recorder.
struct PingEvents {
  server::PingSent sent;
  std::vector<server::WirePassed> batches;  ///< grouped as a head sends them

  PingEvents(const Ping& ping, std::uint64_t number, TimePoint time)
      : sent{ping.record, std::make_shared<const server::PosesUsed>(server::PosesUsed{time, {}, {}, {}})} {
    sent.ping.number = number;
    sent.ping.transmit_time = time;
    for (int i = 0; i < ping.encoded.datagram_count(); ++i) {
      if (i % gemini::DeviceConfig{}.burst_lines == 0) {
        batches.push_back({.to_client = true, .pty = {}, .pieces = {}});
      }
      batches.back().pieces.push_back({{0x7F000001, 52'900}, {0x7F000002, 52'901}, ping.encoded.datagram(i)});
    }
  }
};

struct : server::GlfDevice {
  std::optional<glf::StatusRecord> glf_status(std::span<const std::uint8_t>) const override {
    return std::nullopt;
  }
} without_statuses;
const std::vector<server::HeadToRecord> one_head{{"bow", "gemini_720i", 513, &without_statuses}};

server::RecordingConfig config_of(const fs::path& folder, const std::string& formats) {
  server::RecordingConfig config;
  config.directory = folder;
  config.glf = formats == "glf" || formats == "all_formats";
  config.mcap = formats == "mcap" || formats == "all_formats";
  config.pcapng = formats == "pcapng" || formats == "all_formats";
  config.sync = server::RecordingSync::never;
  return config;
}

/// Times the work of the serving thread for a ping, while the recorder works.
Timing time_serving(const Ping& ping) {
  const ScratchFolder folder;
  const server::SteadyClock clock;
  server::Recorder recorder(config_of(folder.path(), "all_formats"), one_head);
  const server::HeadRecording recording(&recorder, 0, clock);
  Timing timing;
  const double start_s = now_s();
  for (int done = 0; repetition.wants_more(done, start_s); ++done) {
    PingEvents events(ping, static_cast<std::uint64_t>(done), clock.now());
    const double begin_s = now_s();
    recording.posed(events.sent.poses);
    recording.ping(std::move(events.sent));
    for (server::WirePassed& batch : events.batches) {
      recording.wire(std::move(batch));
    }
    timing.add(1e3 * (now_s() - begin_s));
  }
  return timing;
}

/// Processor time of this thread in seconds. The recorder's thread has a low priority, so its wall time
/// depends on other programs.
double cpu_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Times the work of the recorder's thread for a ping: encode, compress and write.
Timing time_writing(const Ping& ping, const std::string& formats) {
  const ScratchFolder folder;
  const server::RecordingConfig config = config_of(folder.path(), formats);
  TimePoint time = server::SteadyClock().now();
  server::LogSet logs(config, one_head, server::unix_time_offset(), time, /*has_room=*/true);
  Timing timing;
  const double start_s = now_s();
  for (int done = 0; repetition.wants_more(done, start_s); ++done) {
    time += ping_interval;
    PingEvents events(ping, static_cast<std::uint64_t>(done), time);
    std::vector<server::RecordingEvent> queued{{0, time, server::PingPosed{events.sent.poses}},
                                               {0, time, std::move(events.sent)}};
    for (server::WirePassed& batch : events.batches) {
      queued.push_back({0, time, std::move(batch)});
    }
    const double begin_s = cpu_s();
    for (const server::RecordingEvent& event : queued) {
      logs.write(event);
      logs.flush(event.time);
    }
    timing.add(1e3 * (cpu_s() - begin_s));
  }
  return timing;
}

}  // namespace

void measure_recording(Measurements& results) {
  const Ping ping = make_ping();
  const auto add = [&](const std::string& formats, const std::string& metric, const Timing& timing) {
    const Subject subject{scene_name, "cpu", formats};
    results.add(subject, metric, timing.median(), "ms");
    results.add(subject, metric + "_p95", timing.p95(), "ms");
  };
  add("all_formats", "recording_serving_ms", time_serving(ping));
  for (const char* formats : {"glf", "mcap", "pcapng", "all_formats"}) {
    add(formats, "recording_writing_ms", time_writing(ping, formats));
  }
}

std::string describe_recording(const Measurements& results) {
  const auto ms = [&](const std::string& formats, const std::string& metric) {
    return results.find({scene_name, "cpu", formats}, metric).value_or(0.0);
  };
  const std::string serving = "recording_serving_ms";
  const std::string writing = "recording_writing_ms";
  return fmt::format(
      "recording a ping of 256 x {}: serving thread {:.3f} ms (p95 {:.3f}), recorder's thread {:.2f} ms of "
      "CPU "
      "(glf {:.2f}, mcap {:.2f}, pcapng {:.2f})\n",
      lines, ms("all_formats", serving), ms("all_formats", serving + "_p95"), ms("all_formats", writing),
      ms("glf", writing), ms("mcap", writing), ms("pcapng", writing));
}

}  // namespace sonard::bench
