// SPDX-License-Identifier: Apache-2.0
// The MCAP file of all heads (docs/logs.md, "MCAP" and "Recording").
#pragma once

#include <map>
#include <memory>
#include <string>

#include "protocol/mcap/writer.hpp"
#include "server/picture/ping_picture.hpp"
#include "server/recording/log_writer.hpp"

namespace sonard::server {

/// Records everything: images, lines, poses, and the bytes of both directions. A chunk is limited in bytes
/// and time. Its data is written to the file with every image and line, and after `longest_wait` at the
/// latest. A killed process thus loses no image taken from the queue, and at most `longest_wait` of bytes.
class McapLogWriter final : public LogWriter {
 public:
  static constexpr std::size_t chunk_bytes = std::size_t{1} << 20;
  static constexpr std::chrono::seconds longest_chunk{1};
  static constexpr std::chrono::milliseconds longest_wait{200};
  /// Interval between pictures of a scanning head, because each line changes only a small part.
  static constexpr std::chrono::seconds sweep_picture_interval{1};

  explicit McapLogWriter(const LogSetting& setting);

  void write(const RecordingEvent& event) override;
  void flush(TimePoint now) override;
  void close() override;

 private:
  void add(int head, TimePoint time, const PingSent& ping);
  void add(int head, TimePoint time, const PingPosed& pose);
  void add(int head, TimePoint time, const WirePassed& wire);
  void add(int, TimePoint, const StatusSent&) {}  // is in the wire bytes
  void add(int, TimePoint, const StreamEnded&) {}

  /// Adds the Foxglove messages of a ping.
  void add_for_foxglove(int head, TimePoint time, const PingSent& ping);
  template <class Message>
  void add_message(const std::string& topic, TimePoint time, std::int64_t publish_ns, const Message& message);
  template <class Message>
  std::uint16_t channel(const std::string& topic);
  void write_taken();
  const HeadToRecord& head_of(int head) const { return setting().heads[static_cast<std::size_t>(head)]; }

  mcap::Writer writer_;
  std::map<std::string, std::uint16_t> schemas_;   ///< by name
  std::map<std::string, std::uint16_t> channels_;  ///< by topic
  std::map<int, PingPicture> pictures_;            ///< by head
  std::map<int, TimePoint> drawn_at_;              ///< when the sweep of a scanning head was last drawn
  bool image_waits_ = false;
  TimePoint flushed_at_{};
  TimePoint chunk_begun_at_{};
};

}  // namespace sonard::server
