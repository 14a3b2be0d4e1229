// SPDX-License-Identifier: Apache-2.0
// The capture of all heads, for Wireshark (docs/logs.md, "pcapng" and "Recording").
#pragma once

#include <map>
#include <tuple>

#include "protocol/pcapng/blocks.hpp"
#include "protocol/pcapng/packets.hpp"
#include "server/recording/log_writer.hpp"

namespace sonard::server {

/// One interface per head. A stream that continues from an earlier file starts a new connection in this file.
class PcapngLogWriter final : public LogWriter {
 public:
  explicit PcapngLogWriter(const LogSetting& setting);

  void write(const RecordingEvent& event) override;
  void flush(TimePoint now) override;
  void close() override;

 private:
  using StreamKey = std::tuple<int, std::uint32_t, std::uint16_t, std::string>;  ///< head, client, or pty

  void write_datagrams(const RecordingEvent& event, const WirePassed& wire);
  void write_stream(const RecordingEvent& event, const WirePassed& wire);
  void end_stream(const RecordingEvent& event, const WireEnds& ends);
  void add(const RecordingEvent& event, const std::vector<pcapng::Bytes>& packets);

  pcapng::Writer writer_;
  std::map<StreamKey, pcapng::TcpConversation> streams_;
};

}  // namespace sonard::server
