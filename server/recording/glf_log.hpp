// SPDX-License-Identifier: Apache-2.0
// The .dat of one head while it grows (docs/logs.md 1 and "Recording").
#pragma once

#include "server/recording/glf_records.hpp"
#include "server/recording/log.hpp"

namespace sonard::server {

/// Begins with a ping; statuses before the first are left out. A .dat is a log by itself after every record.
/// What makes a .glf of it is GlfPacking.
class GlfLog final : public Log {
 public:
  /// @param head the place of a head with a glf_number in LogSetting::heads
  GlfLog(const LogSetting& setting, int head) : Log(setting), head_(head) {}

  void write(const RecordingEvent& event) override;
  void flush(TimePoint) override {}  // every record is written at once
  void close() override { file().end(); }

 private:
  void write(const PingSent& sent);
  void write(const StatusSent& status, TimePoint time);
  GlfLogOrigin origin() const;
  const HeadToRecord& head() const { return setting().heads[static_cast<std::size_t>(head_)]; }

  int head_;
};

}  // namespace sonard::server
