// SPDX-License-Identifier: Apache-2.0
// The images of a .glf or .dat.
#pragma once

#include "protocol/glf/log_view.hpp"
#include "server/logs/recording.hpp"

namespace sonard::server {

class GlfRecording final : public Recording {
 public:
  /// @throws LogError
  explicit GlfRecording(const LogFile& file);

  std::vector<std::uint8_t> samples(const LoggedPing& ping) const override;
  std::vector<std::string> problems() const override;
  bool closed() const override { return view_.index().closed && !cut_; }
  const glf::LogView& view() const { return view_; }

 private:
  const LogFile& file_;
  bool cut_ = false;  ///< before view_, which sets it
  glf::LogView view_;
  std::uint64_t bad_images_ = 0;
};

}  // namespace sonard::server
