// SPDX-License-Identifier: Apache-2.0
// An .mcap of many pings with topics for Foxglove, made in one run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/heads/head_config.hpp"
#include "server/offline/output_folder.hpp"
#include "server/recording/mcap_log_writer.hpp"
#include "server/recording/recording_config.hpp"

namespace sonard::server {

/// Has the content that a daemon's recorder would write for the same pings, without wire bytes. The same
/// pings give the same bytes. The log gets its name at the end.
class McapFile {
 public:
  /// @param heads of the configuration; must outlive this object
  /// @throws Error
  McapFile(const OutputFolder& folder, const std::vector<HeadConfig>& heads);

  /// @param head index in the configuration
  /// @throws Error
  void add(int head, const PingSent& ping);
  /// @throws Error
  void publish(const std::string& name);

 private:
  void check() const;

  const OutputFolder& folder_;
  RecordingConfig config_;
  std::vector<HeadToRecord> heads_;
  LogSetting setting_;
  McapLogWriter log_;
};

}  // namespace sonard::server
