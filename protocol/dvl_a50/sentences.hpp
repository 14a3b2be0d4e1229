// SPDX-License-Identifier: Apache-2.0
// Sentences of the serial line (6). Texts are without the end of the line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/dvl_a50/messages.hpp"

namespace sonard::dvl_a50 {

/// CRC-8 with the polynomial 0x07 and the initial value 0.
std::uint8_t crc8(std::string_view text);
/// With `*` and the checksum.
std::string with_checksum(std::string_view text);

/// wrz, or wrs in water tracking.
std::string velocity_sentence(const Velocity& report);
std::string beam_sentence(const Beam& beam);                ///< wru
std::string position_sentence(const Position& report);      ///< wrp
std::string old_velocity_sentence(const Velocity& report);  ///< wrx
std::string old_distance_sentence(const Velocity& report);  ///< wrt
std::string settings_text(const Settings& settings);        ///< wrc, without its checksum

/// A command: its letters, such as "wcs", and its options.
struct SerialCommand {
  std::string name;
  std::vector<std::string> options;
  bool checked = true;  ///< false: the checksum is wrong
};
/// @return nullopt if the line is no command
std::optional<SerialCommand> parse_command(std::string_view line);

/// Applies the options of wcs; an empty one changes nothing.
/// @return false if their number or the form of one is wrong; then nothing is changed
bool apply(const std::vector<std::string>& options, Settings& settings);

}  // namespace sonard::dvl_a50
