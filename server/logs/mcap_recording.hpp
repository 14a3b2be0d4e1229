// The images of sonard's own .mcap.
#pragma once

#include <optional>
#include <set>
#include <span>

#include "protocol/mcap/reader.hpp"
#include "server/logs/recording.hpp"

namespace sonard::server {

class McapRecording final : public Recording {
 public:
  /// @throws LogError
  explicit McapRecording(const LogFile& file);

  std::vector<std::uint8_t> pixels(const RecordedImage& image) const override;
  std::vector<std::string> problems() const override;
  bool closed() const override { return reader_.finished(); }
  const mcap::Reader& reader() const { return reader_; }
  /// Channels whose messages are of this schema, for example "sonard.log.SonarImage".
  std::set<std::uint16_t> channels_of(std::string_view schema) const;

 private:
  void add(std::span<const std::uint8_t> message);

  const LogFile& file_;
  mcap::Reader reader_;
  std::vector<std::span<const std::uint8_t>> messages_;  ///< of images; views of the file
  std::uint64_t bad_messages_ = 0;
  std::optional<WireError> unreadable_;  ///< why the images end before the file does
};

}  // namespace sonard::server
