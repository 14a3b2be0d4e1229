// SPDX-License-Identifier: Apache-2.0
// Reads the images and scan lines of sonard's own .mcap.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <vector>

#include "protocol/mcap/reader.hpp"
#include "server/logs/log_reader.hpp"

namespace sonard::server {

class McapLogReader final : public LogReader {
 public:
  /// @throws Error
  explicit McapLogReader(const LogFile& file);

  std::vector<std::uint8_t> samples(const LoggedPing& ping) const override;
  std::vector<std::string> problems() const override;
  bool closed() const override { return reader_.finished(); }
  const mcap::Reader& reader() const { return reader_; }

 private:
  /// The message of a ping: a view of the file, or its place in a chunk.
  struct Message {
    std::span<const std::uint8_t> bytes;
    std::optional<mcap::MessagePlace> place;
    bool is_line = false;
  };

  void read_pings();
  std::set<std::uint16_t> channels_of(std::string_view schema) const;
  std::string lost_pings(const mcap::DamagedChunk& part) const;
  bool add_image(std::span<const std::uint8_t> bytes);
  bool add_line(std::span<const std::uint8_t> bytes);

  const LogFile& file_;
  mcap::Reader reader_;
  std::vector<Message> messages_;
  std::uint64_t bad_images_ = 0;
  std::uint64_t bad_lines_ = 0;
  std::vector<mcap::DamagedChunk> damaged_;
  std::set<std::uint16_t> ping_channels_;
};

}  // namespace sonard::server
