// SPDX-License-Identifier: Apache-2.0
#include "server/recording/log_set.hpp"

#include <algorithm>
#include <ctime>

#include "protocol/glf/log_time.hpp"
#include "server/recording/glf_log_writer.hpp"
#include "server/recording/log_names.hpp"
#include "server/recording/mcap_log_writer.hpp"
#include "server/recording/packet_log_writer.hpp"
#include "server/recording/pcapng_log_writer.hpp"

namespace sonard::server {
namespace {

std::int32_t utc_offset_s(RecordingZone zone) {
  if (zone == RecordingZone::utc) {
    return 0;
  }
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  return static_cast<std::int32_t>(local.tm_gmtoff);
}

}  // namespace

LogSet::LogSet(const RecordingConfig& config, const std::vector<HeadToRecord>& heads,
               std::chrono::nanoseconds unix_offset, TimePoint begin, bool has_room)
    : setting_{config, heads, unix_offset, utc_offset_s(config.zone), {}}, begin_(begin) {
  setting_.stem =
      free_stem(config.directory, glf::glf_time_s(setting_.unix_ns(begin), setting_.utc_offset_s));
  if (!has_room) {
    return;
  }
  if (config.mcap) {
    logs_.push_back(std::make_unique<McapLogWriter>(setting_));
  }
  if (config.pcapng) {
    logs_.push_back(std::make_unique<PcapngLogWriter>(setting_));
  }
  for (std::size_t head = 0; config.glf && head < heads.size(); ++head) {
    if (heads[head].glf != nullptr) {
      logs_.push_back(std::make_unique<GlfLogWriter>(setting_, static_cast<int>(head)));
    }
  }
  for (std::size_t head = 0; config.sonar && head < heads.size(); ++head) {
    if (heads[head].has_packet_log) {
      logs_.push_back(std::make_unique<PacketLogWriter>(setting_, static_cast<int>(head)));
    }
  }
}

void LogSet::write(const RecordingEvent& event) {
  for (const std::unique_ptr<LogWriter>& log : logs_) {
    log->write(event);
  }
}

bool LogSet::any_good() const {
  return std::ranges::any_of(logs_, [](const std::unique_ptr<LogWriter>& log) {
    return log->file().begun() && !log->file().failed();
  });
}

void LogSet::flush(TimePoint now) {
  for (const std::unique_ptr<LogWriter>& log : logs_) {
    log->flush(now);
  }
}

void LogSet::sync() {
  for (const std::unique_ptr<LogWriter>& log : logs_) {
    log->file().sync();
  }
}

bool LogSet::is_over(TimePoint now) const {
  return now - begin_ >= setting_.config.rotate_after ||
         std::ranges::any_of(logs_, [&](const std::unique_ptr<LogWriter>& log) {
           return log->file().size() >= setting_.config.rotate_bytes;
         });
}

LogSet::Closed LogSet::close() {
  Closed closed;
  for (const std::unique_ptr<LogWriter>& log : logs_) {
    log->close();
    if (!log->file().begun()) {
      continue;
    }
    ++(log->file().failed() ? closed.failed : closed.written);
    if (!stem_of_dat(log->file().path()).empty()) {
      closed.dats.push_back(log->file().path());
    }
  }
  return closed;
}

}  // namespace sonard::server
