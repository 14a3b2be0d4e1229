// SPDX-License-Identifier: Apache-2.0
// Reads the images of a .glf or .dat.
#pragma once

#include <optional>
#include <vector>

#include "protocol/common/damage.hpp"
#include "protocol/glf/log_view.hpp"
#include "server/logs/log_reader.hpp"

namespace sonard::server {

class GlfLogReader final : public LogReader {
 public:
  /// Unpacks each image once: a damaged image is not a ping, but a problem().
  /// @throws Error
  explicit GlfLogReader(const LogFile& file);

  std::vector<std::uint8_t> samples(const LoggedPing& ping) const override;
  std::vector<std::string> problems() const override;
  bool closed() const override { return view_.index().closed && !archive_error_; }
  const glf::LogView& view() const { return view_; }

 private:
  const LogFile& file_;
  std::optional<WireError>
      archive_error_;  ///< damage of the archive itself; declared before view_, which sets it
  glf::LogView view_;
  std::vector<Damage> damaged_images_;  ///< whole records with an undecodable image; offsets in the .dat
  std::uint64_t bad_images_ = 0;
};

}  // namespace sonard::server
