// SPDX-License-Identifier: Apache-2.0
// Writes the .dat of one head (protocol/glf/README.md and "Recording").
#pragma once

#include "server/recording/glf_records.hpp"
#include "server/recording/log_writer.hpp"

namespace sonard::server {

/// Starts with the first ping; earlier statuses are omitted. A .dat is a valid log after every record.
/// GlfPacking makes a .glf from it.
class GlfLogWriter final : public LogWriter {
 public:
  /// @param head index in LogSetting::heads; the head has .glf logs
  GlfLogWriter(const LogSetting& setting, int head);

  void write(const RecordingEvent& event) override;
  void flush(TimePoint) override {}  // every record is written at once
  void close() override { file().end(); }

 private:
  void write(const PingSent& sent);
  void write(const StatusSent& status, TimePoint time);
  const HeadToRecord& head() const { return setting().heads[static_cast<std::size_t>(head_)]; }

  int head_;
  GlfLogOrigin origin_;
};

}  // namespace sonard::server
