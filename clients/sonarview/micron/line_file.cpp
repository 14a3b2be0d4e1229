// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/micron/line_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace sonard::client {

LineFile::LineFile(std::filesystem::path path) : path_(std::move(path)), out_(path_, std::ios::trunc) {
  if (!out_) {
    throw std::runtime_error(
        fmt::format("cannot write {}: {}", path_.string(), std::generic_category().message(errno)));
  }
}

void LineFile::write(const micron::ReceivedLine& line, std::uint64_t sweep) {
  const micron::HeadData& head = line.head;
  const double unix_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  std::string text = fmt::format(
      R"({{"number":{},"turn":{},"unix_s":{:.6f},"bearing":{},"status":{},"sweep":{},"control":{},)"
      R"("range_scale":{},"tx_word":{},"gain":{},"slope":{},"ad_span":{},"ad_low":{},"heading_offset":{},)"
      R"("ad_interval":{},"left_limit":{},"right_limit":{},"step":{},"all_round":{},"bits":{},"bins":")",
      line.number, sweep, unix_s, head.bearing, head.status, static_cast<int>(head.sweep), head.control,
      head.range_scale, head.tx_word, head.gain, head.slope, head.ad_span, head.ad_low, head.heading_offset,
      head.ad_interval, head.left_limit, head.right_limit, head.step,
      (head.control & micron::control_bits::continuous) != 0, head.eight_bit() ? 8 : 4);
  for (const std::uint8_t bin : line.bins) {
    text += fmt::format("{:02x}", bin);
  }
  text += "\"}\n";
  out_ << text << std::flush;
}

}  // namespace sonard::client
