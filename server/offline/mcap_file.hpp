// SPDX-License-Identifier: Apache-2.0
// An .mcap of many pings with topics for Foxglove, made in one go.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/config/config.hpp"
#include "server/offline/output_folder.hpp"
#include "server/recording/mcap_log.hpp"

namespace sonard::server {

/// Holds what the recorder of a daemon would have written for the same pings, without the bytes of the wire.
/// The same pings make the same bytes. The log gets its name at the end.
class McapFile {
 public:
  /// @param heads of the configuration; they outlive this
  /// @throws OutputError
  McapFile(const OutputFolder& folder, const std::vector<HeadConfig>& heads);

  /// @param head its place in the configuration
  /// @throws OutputError
  void add(int head, const PingSent& ping);
  /// @throws OutputError
  void publish(const std::string& name);

 private:
  void check() const;

  const OutputFolder& folder_;
  RecordingConfig config_;
  std::vector<HeadToRecord> heads_;
  LogSetting setting_;
  McapLog log_;
};

}  // namespace sonard::server
