// SPDX-License-Identifier: Apache-2.0
#include "server/devices/sonar3d15/packet_log.hpp"

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/sonar3d15/recording.hpp"
#include "protocol/sonar3d15/shot.hpp"
#include "server/logs/damage_text.hpp"

namespace sonard::server {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// Nullopt if it is not a plausible_time().
std::optional<std::int64_t> unix_ns(const google::protobuf::Timestamp& stamp) {
  constexpr std::int64_t second_ns = 1'000'000'000, most_s = 4'000'000'000;
  return stamp.seconds() > -most_s && stamp.seconds() < most_s
             ? std::optional(stamp.seconds() * second_ns + stamp.nanos())
             : std::nullopt;
}

class Sonar3d15Log final : public LogReader {
 public:
  Sonar3d15Log(const LogFile& file, std::string type) : type_(std::move(type)) {
    damages_ = sonar3d15::for_each_packet(file.bytes(), [&](Bytes packet) { take(packet); });
    add_unpaired();
    if (packets_ == 0) {
      throw file.error("holds no packet that can be read");
    }
    sort_by_time();
  }

  std::vector<std::uint8_t> samples(const LoggedPing& ping) const override {
    return sonar3d15::record_of(*sonar3d15::recorded_form(ping.wire), 0.0, {}).samples;
  }

  std::vector<std::string> problems() const override {
    std::vector<std::string> problems;
    add_damage(problems, damages_, [](const Damage&) { return "the packets in them are lost"; });
    return problems;
  }

  bool closed() const override { return true; }

  std::vector<std::pair<std::string, std::uint64_t>> other_records() const override {
    std::vector<std::pair<std::string, std::uint64_t>> found;
    for (const auto& [what, number] :
         {std::pair{"images without the other one of their shot", unpaired_},
          std::pair{"IMU batches", batches_}, std::pair{"packets of other types", others_}}) {
      if (number > 0) {
        found.emplace_back(what, number);
      }
    }
    return found;
  }

 private:
  void take(Bytes packet) {
    ++packets_;
    const auto message = sonar3d15::decode(packet);
    if (message && std::holds_alternative<sonar3d15::RangeImage>(*message)) {
      add_unpaired();
      ranges_.assign(packet.begin(), packet.end());
    } else if (message && std::holds_alternative<sonar3d15::BitmapImageGreyscale8>(*message)) {
      take_signal(packet, std::get<sonar3d15::BitmapImageGreyscale8>(*message));
    } else if (message && std::holds_alternative<sonar3d15::ImuBatch>(*message)) {
      ++batches_;
    } else {
      ++others_;
    }
  }

  void take_signal(Bytes packet, const sonar3d15::BitmapImageGreyscale8& signal) {
    if (signal.type() != waterlinked::sonar::protocol::SIGNAL_STRENGTH_IMAGE) {
      ++others_;
      return;
    }
    std::vector<std::uint8_t> wire = std::exchange(ranges_, {});
    unpaired_ += wire.empty() ? 1 : 0;
    wire.insert(wire.end(), packet.begin(), packet.end());
    const auto shot = sonar3d15::recorded_form(wire);
    const auto time_ns = shot ? unix_ns(shot->range.header().timestamp()) : std::nullopt;
    if (!time_ns || shot->range.header().sequence_id() != shot->signal.header().sequence_id()) {
      unpaired_ += wire.size() > packet.size() ? 2 : 0;
      return;
    }
    PingRecord record = sonar3d15::record_of(*shot, 0.0, {});
    LoggedHead& head = this->head({}, 0, /*scanning=*/false);
    head.type = type_;
    if (head.pings.empty()) {
      head.bearings_rad = std::move(record.bearings_rad);
    }
    head.pings.push_back({.time_ns = *time_ns,
                          .settings = record.settings,
                          .wire = std::move(wire),
                          .place = head.pings.size()});
  }

  void add_unpaired() { unpaired_ += std::exchange(ranges_, {}).empty() ? 0 : 1; }

  const std::string type_;
  std::vector<Damage> damages_;
  std::vector<std::uint8_t> ranges_;  ///< packet of the range image that waits for its signal image
  std::uint64_t packets_ = 0, unpaired_ = 0, batches_ = 0, others_ = 0;
};

}  // namespace

std::unique_ptr<LogReader> read_sonar3d15_log(const LogFile& file, const std::string& type) {
  return std::make_unique<Sonar3d15Log>(file, type);
}

}  // namespace sonard::server
