// SPDX-License-Identifier: Apache-2.0
#include "server/logs/glf_log_reader.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "protocol/glf/log_time.hpp"
#include "server/logs/damage_text.hpp"

namespace sonard::server {
namespace {

glf::LogView opened(const LogFile& file, std::optional<WireError>& archive_error) {
  auto view = glf::LogView::open(file.bytes());
  if (view) {
    return std::move(*view);
  }
  if (auto left = glf::LogView::open_damaged(file.bytes())) {
    archive_error = view.error();
    return std::move(*left);
  }
  throw file.error(to_string(view.error()));
}

RecordedSettings settings_of(const glf::ImageRecord& image) {
  RecordedSettings settings;
  settings.bins = static_cast<int>(image.lines);
  settings.beams = static_cast<int>(image.beams);
  settings.sound_speed_mps = image.sound_speed_mps;
  settings.bin_m = image.sound_speed_mps / 2.0 / image.modulation_frequency_hz;
  settings.sound_speed_from_config = (image.ping_flags & glf::ping_flag_bits::manual_sound_speed) != 0;
  settings.gain_percent = image.gain_percent;
  return settings;
}

// Logs of other programs may hold any values.
bool makes_sense(const glf::ImageRecord& image) {
  return image.lines > 0 && image.beams > 0 && image.modulation_frequency_hz > 0 &&
         std::isfinite(image.sound_speed_mps) && image.sound_speed_mps > 0.0F;
}

}  // namespace

GlfLogReader::GlfLogReader(const LogFile& file) : file_(file), view_(opened(file, archive_error_)) {
  const auto& records = view_.index().records;
  for (std::size_t place = 0; place < records.size(); ++place) {
    if (records[place].type != glf::RecordType::image) {
      continue;
    }
    const auto image = view_.image(records[place]);  // unpacked, so that problems() knows each lost image
    if (!image) {
      damaged_images_.push_back({records[place].offset, records[place].size, image.error()});
      continue;
    }
    const std::optional<std::int64_t> time_ns = glf::unix_ns(image->transmit_time_s, 0);
    if (!time_ns || !plausible_time(*time_ns) || !makes_sense(*image)) {
      ++bad_images_;
      continue;
    }
    LoggedHead& head = this->head({}, image->origin.device_id, /*scanning=*/false);
    if (head.pings.empty()) {
      std::ranges::transform(image->bearings_rad, std::back_inserter(head.bearings_rad),
                             glf::bearing_for_log);
    }
    head.pings.push_back({.time_ns = *time_ns, .settings = settings_of(*image), .wire = {}, .place = place});
  }
  sort_by_time();
}

std::vector<std::uint8_t> GlfLogReader::samples(const LoggedPing& ping) const {
  auto record = view_.image(view_.index().records.at(ping.place));
  if (!record) {
    throw file_.error(to_string(record.error()));
  }
  return std::move(record->pixels);
}

std::vector<std::string> GlfLogReader::problems() const {
  const glf::DatIndex& index = view_.index();
  std::vector<std::string> problems;
  if (archive_error_) {
    problems.push_back(
        archive_error_->reason == WireErrorReason::truncated
            ? "cut: the end of the archive is missing"
            : fmt::format("damaged: the archive around the records ({}); the log was searched for "
                          "records",
                          to_string(*archive_error_)));
  }
  if (view_.unread_size() > 0) {
    problems.push_back(
        fmt::format("damaged: {} bytes at the end of the file are not read, because no block begins in them",
                    view_.unread_size()));
  }
  add_damage(problems, index.damaged,
             [](const Damage&) { return std::string("the images and statuses in them are lost"); });
  add_damage(problems, damaged_images_, [](const Damage&) { return std::string("1 ping is lost"); });
  if (index.tail_size > 0) {
    problems.push_back(fmt::format("cut or damaged: {} bytes after the last whole record cannot be read ({})",
                                   index.tail_size,
                                   index.tail_error ? to_string(*index.tail_error) : "no record"));
  } else if (!index.closed && !archive_error_) {
    problems.emplace_back("not closed: still being written, or the writing program ended early");
  }
  if (bad_images_ > 0) {
    problems.push_back(fmt::format("{} images have impossible values and are left out", bad_images_));
  }
  return problems;
}

}  // namespace sonard::server
