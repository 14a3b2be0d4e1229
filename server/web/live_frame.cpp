// SPDX-License-Identifier: Apache-2.0
#include "server/web/live_frame.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "protocol/common/linear_samples.hpp"
#include "server/web/json.hpp"
#include "server/web/little_endian.hpp"

namespace sonard::server {
namespace {

/// How many rows to merge into one, so that at most `most` rows are left.
int rows_in_one(int rows, int most) {
  return std::max(1, (rows + most - 1) / most);
}

nlohmann::json header_of(const ShownPing& newest, std::size_t lines, int step, TimePoint now) {
  const PingRecord& record = newest.record;
  const bool scanning = record.settings.beams == 1;
  nlohmann::json header{{"type", "ping"},
                        {"head", newest.head},
                        {"number", record.number},
                        {"time_s", std::chrono::duration<double>(newest.time).count()},
                        {"age_s", std::chrono::duration<double>(now - newest.time).count()},
                        {"beams", record.settings.beams},
                        {"rows", (record.settings.bins + step - 1) / step},
                        {"bin_m", record.settings.bin_m * step},
                        {"range_m", record.settings.range_m()},
                        {"sector_rad", record.sector_rad},
                        {"scanning", scanning},
                        {"bits", record.bits_per_bin},
                        {"pose", nullptr}};
  if (scanning) {
    header["lines"] = lines;
  }
  if (newest.T_world_mount) {
    header["pose"] = placed_json(*newest.T_world_mount);
  }
  return header;
}

void append_samples(std::string& out, const PingRecord& record, int step) {
  const auto beams = static_cast<std::size_t>(record.settings.beams);
  const std::size_t rows = record.samples.size() / beams;
  const std::size_t begin = out.size();
  for (std::size_t first = 0; first < rows; first += static_cast<std::size_t>(step)) {
    const std::size_t end = std::min(rows, first + static_cast<std::size_t>(step));
    const std::size_t at = out.size();
    out.append(reinterpret_cast<const char*>(&record.samples[first * beams]), beams);
    for (std::size_t row = first + 1; row < end; ++row) {
      for (std::size_t beam = 0; beam < beams; ++beam) {
        const std::uint8_t sample = record.samples[row * beams + beam];
        if (sample > static_cast<std::uint8_t>(out[at + beam])) {
          out[at + beam] = static_cast<char>(sample);
        }
      }
    }
  }
  make_linear({reinterpret_cast<std::uint8_t*>(out.data()) + begin, out.size() - begin},
              record.settings.amplitude_exponent);
}

}  // namespace

std::string live_frame(std::span<const std::shared_ptr<const ShownPing>> pings, int max_rows, TimePoint now) {
  const ShownPing& newest = *pings.back();
  const int step = rows_in_one(newest.record.settings.bins, max_rows);
  std::string header = text_of(header_of(newest, pings.size(), step, now));
  header.resize((header.size() + 3) / 4 * 4, ' ');

  std::string out;
  append_number(out, static_cast<std::uint32_t>(header.size()));
  out += header;
  for (const std::shared_ptr<const ShownPing>& ping : pings) {
    for (const double bearing_rad : ping->record.bearings_rad) {
      append_number(out, static_cast<float>(-bearing_rad));
    }
  }
  for (const std::shared_ptr<const ShownPing>& ping : pings) {
    append_samples(out, ping->record, step);
  }
  return out;
}

}  // namespace sonard::server
