// SPDX-License-Identifier: Apache-2.0
// Writes the .sonar of one head: its datagrams, one after another.
#pragma once

#include "server/recording/log_writer.hpp"

namespace sonard::server {

/// Starts with the first datagram that the head sends. A .sonar is a valid log after every datagram.
class PacketLogWriter final : public LogWriter {
 public:
  /// @param head index in LogSetting::heads
  PacketLogWriter(const LogSetting& setting, int head) : LogWriter(setting), head_(head) {}

  void write(const RecordingEvent& event) override;
  void flush(TimePoint) override {}  // every datagram is written at once
  void close() override { file().end(); }

 private:
  int head_;
};

}  // namespace sonard::server
