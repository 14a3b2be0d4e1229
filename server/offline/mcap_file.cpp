// SPDX-License-Identifier: Apache-2.0
#include "server/offline/mcap_file.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include <spdlog/spdlog.h>

#include "server/devices/device_type.hpp"

namespace sonard::server {
namespace {

constexpr const char* part_name = ".part-mcap";  // removed by OutputFolder::remove_parts()

RecordingConfig foxglove_alone() {
  RecordingConfig config;
  config.mcap_wire_bytes = false;
  config.mcap_foxglove = true;
  return config;
}

}  // namespace

McapFile::McapFile(const OutputFolder& folder, const std::vector<HeadConfig>& heads)
    : folder_(folder),
      config_(foxglove_alone()),
      heads_(recorded_heads(heads)),
      setting_{config_, heads_, {}, 0, ""},
      log_(setting_) {
  folder_.remove(part_name);  // from an interrupted run
  log_.file().begin(folder_.path() / part_name, GrowingLog::Lines::none);
  check();
}

void McapFile::add(int head, const PingSent& ping) {
  const TimePoint time = ping.ping.transmit_time;
  log_.write({head, time, PingPosed{ping.poses}});
  log_.write({head, time, ping});
  log_.flush(time);
  check();
}

void McapFile::publish(const std::string& name) {
  log_.close();
  check();
  if (std::rename((folder_.path() / part_name).c_str(), (folder_.path() / name).c_str()) != 0) {
    throw output_error(folder_.path() / name, "cannot create it: " + std::generic_category().message(errno));
  }
  spdlog::info("render: wrote {}", (folder_.path() / name).string());
}

void McapFile::check() const {
  if (log_.file().failed()) {
    throw output_error(folder_.path(), "cannot write the .mcap file in it: " + log_.file().error().message());
  }
}

}  // namespace sonard::server
