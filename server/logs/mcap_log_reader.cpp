// SPDX-License-Identifier: Apache-2.0
#include "server/logs/mcap_log_reader.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "protocol/log/log_messages.hpp"
#include "server/logs/damage_text.hpp"

namespace sonard::server {
namespace {

constexpr std::size_t most_line_bins = 65'535;  // more than any scanning head sends

mcap::Reader opened(const LogFile& file) {
  auto reader = mcap::Reader::open(file.bytes());
  if (!reader) {
    throw file.error(
        fmt::format("is not an .mcap log, or none of its pings can be read ({})", to_string(reader.error())));
  }
  return std::move(*reader);
}

bool makes_sense(const log::SonarImage& image) {
  return !log::problem_of(image) && plausible_time(image.transmit_time_ns()) && image.range_lines() > 0 &&
         image.beams() > 0 && image.device_id() <= std::numeric_limits<std::uint16_t>::max() &&
         std::isfinite(image.metres_per_line()) && image.metres_per_line() > 0.0 &&
         std::isfinite(image.sound_speed_mps()) && image.sound_speed_mps() > 0.0;
}

RecordedSettings settings_of(const log::SonarImage& image) {
  RecordedSettings settings;
  settings.bins = static_cast<int>(image.range_lines());
  settings.beams = static_cast<int>(image.beams());
  settings.bin_m = image.metres_per_line();
  settings.sound_speed_mps = image.sound_speed_mps();
  settings.gain_percent = image.gain_percent();
  settings.frequency_hz = image.frequency_hz();
  const double exponent = image.amplitude_exponent();
  settings.amplitude_exponent = std::isfinite(exponent) && exponent > 0.0 ? exponent : 1.0;
  return settings;
}

bool makes_sense(const log::ScanLine& line) {
  return plausible_time(line.transmit_time_ns()) && !line.bins().empty() &&
         line.bins().size() <= most_line_bins &&
         line.device_id() <= std::numeric_limits<std::uint16_t>::max() && std::isfinite(line.bearing_rad()) &&
         std::isfinite(line.metres_per_bin()) && line.metres_per_bin() > 0.0 &&
         std::isfinite(line.sound_speed_mps()) && line.sound_speed_mps() > 0.0;
}

RecordedSettings settings_of(const log::ScanLine& line) {
  RecordedSettings settings;
  settings.bins = static_cast<int>(line.bins().size());
  settings.beams = 1;
  settings.bin_m = line.metres_per_bin();
  settings.sound_speed_mps = line.sound_speed_mps();
  settings.gain_percent = line.gain_percent();
  settings.frequency_hz = line.frequency_hz();
  return settings;
}

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

}  // namespace

McapLogReader::McapLogReader(const LogFile& file) : file_(file), reader_(opened(file)) {
  damaged_ = reader_.damaged();
  read_pings();
  sort_by_time();
}

void McapLogReader::read_pings() {
  const std::set<std::uint16_t> lines = channels_of("sonard.log.ScanLine");
  ping_channels_ = channels_of("sonard.log.SonarImage");
  ping_channels_.insert(lines.begin(), lines.end());
  if (ping_channels_.empty()) {
    return;  // an empty list would mean all channels
  }
  mcap::MessageCursor cursor = reader_.messages(ping_channels_);
  while (const std::optional<mcap::Message> message = cursor.next()) {
    const bool is_line = lines.contains(message->channel_id);
    if (is_line ? add_line(message->data) : add_image(message->data)) {
      const auto place = cursor.place();
      messages_.push_back({place ? std::span<const std::uint8_t>() : message->data, place, is_line});
    }
  }
  damaged_.insert(damaged_.end(), cursor.damaged().begin(), cursor.damaged().end());
}

bool McapLogReader::add_image(std::span<const std::uint8_t> bytes) {
  const auto image = log::decode<log::SonarImage>(bytes);
  if (!image || !makes_sense(*image)) {
    ++bad_images_;
    return false;
  }
  LoggedHead& head = this->head(image->head(), static_cast<std::uint16_t>(image->device_id()), false);
  if (head.pings.empty()) {
    head.type = image->type();
    std::ranges::transform(image->bearings_rad(), std::back_inserter(head.bearings_rad),
                           log::bearing_for_log);
  }
  head.pings.push_back({.time_ns = image->transmit_time_ns(),
                        .settings = settings_of(*image),
                        .wire = bytes_of(image->wire_head()),
                        .place = messages_.size()});
  return true;
}

bool McapLogReader::add_line(std::span<const std::uint8_t> bytes) {
  const auto line = log::decode<log::ScanLine>(bytes);
  if (!line || !makes_sense(*line)) {
    ++bad_lines_;
    return false;
  }
  LoggedHead& head = this->head(line->head(), static_cast<std::uint16_t>(line->device_id()), true);
  if (head.pings.empty()) {
    head.type = line->type();
  }
  head.pings.push_back({.time_ns = line->transmit_time_ns(),
                        .settings = settings_of(*line),
                        .bearing_rad = log::bearing_for_log(line->bearing_rad()),
                        .bits_per_bin = line->bits_per_bin() == 4 ? 4 : 8,
                        .wire = bytes_of(line->wire_line()),
                        .place = messages_.size()});
  return true;
}

std::vector<std::uint8_t> McapLogReader::samples(const LoggedPing& ping) const {
  const Message& message = messages_.at(ping.place);
  const std::optional<mcap::Bytes> unpacked =
      message.place ? reader_.data_at(*message.place) : std::optional(mcap::Bytes());
  if (!unpacked) {
    throw file_.error("a ping cannot be read");  // it was readable when the log was opened
  }
  const std::span<const std::uint8_t> bytes = message.place ? std::span(*unpacked) : message.bytes;
  if (message.is_line) {
    if (const auto line = log::decode<log::ScanLine>(bytes)) {
      return bytes_of(line->bins());
    }
  } else if (const auto image = log::decode<log::SonarImage>(bytes)) {
    return bytes_of(image->pixels());
  }
  throw file_.error("a ping cannot be read");  // it was readable when the log was opened
}

std::string McapLogReader::lost_pings(const mcap::DamagedChunk& part) const {
  if (part.holds == mcap::Holds::no_message) {
    return "no ping is lost";
  }
  if (part.lost_messages.empty()) {
    return part.holds == mcap::Holds::unknown ? "pings may be lost" : "its pings are lost";
  }
  std::uint64_t pings = 0;
  for (const auto& [channel, messages] : part.lost_messages) {
    pings += ping_channels_.contains(channel) ? messages : 0;
  }
  return pings == 0 ? "no ping is lost" : fmt::format("{} ping{} lost", pings, pings == 1 ? " is" : "s are");
}

std::set<std::uint16_t> McapLogReader::channels_of(std::string_view schema) const {
  std::set<std::uint16_t> ids;
  for (const mcap::Channel& channel : reader_.summary().channels) {
    const mcap::Schema* const found = reader_.summary().schema(channel.schema_id);
    if (found != nullptr && found->name == schema && found->encoding == log::encoding_name) {
      ids.insert(channel.id);
    }
  }
  return ids;
}

std::vector<std::string> McapLogReader::problems() const {
  std::vector<std::string> problems;
  if (!reader_.finished()) {
    problems.emplace_back("not closed: cut, still being written, or the writing program ended early");
  } else if (reader_.lacks_summary()) {
    problems.emplace_back("the index at its end is damaged: the whole log was searched for pings");
  }
  if (const std::optional<WireError>& error = reader_.stopped_by()) {
    problems.push_back(fmt::format("damaged: the last {} bytes cannot be read ({})", reader_.tail_size(),
                                   to_string(*error)));
  } else if (reader_.tail_size() > 0) {
    problems.push_back(fmt::format("the last {} bytes are an incomplete record", reader_.tail_size()));
  }
  add_damage(problems, damaged_, [&](const mcap::DamagedChunk& part) { return lost_pings(part); });
  std::uint64_t unknown = 0;
  for (const auto& [channel, messages] : reader_.summary().message_counts) {
    unknown += reader_.summary().channel(channel) == nullptr ? messages : 0;
  }
  if (unknown > 0) {
    problems.push_back(fmt::format("{} messages belong to no channel and are left out", unknown));
  }
  if (bad_images_ > 0) {
    problems.push_back(fmt::format("{} images cannot be decoded and are left out", bad_images_));
  }
  if (bad_lines_ > 0) {
    problems.push_back(fmt::format("{} scan lines cannot be decoded and are left out", bad_lines_));
  }
  return problems;
}

}  // namespace sonard::server
