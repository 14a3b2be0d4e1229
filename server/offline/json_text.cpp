// SPDX-License-Identifier: Apache-2.0
#include "server/offline/json_text.hpp"

#include <fmt/format.h>

namespace sonard::server {

std::string json_string(std::string_view text) {
  std::string json = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') {
      json += '\\';
      json += letter;
    } else if (static_cast<unsigned char>(letter) < 0x20) {
      json += fmt::format("\\u{:04x}", static_cast<int>(letter));
    } else {
      json += letter;
    }
  }
  return json + '"';
}

std::string json_list(const std::vector<double>& numbers) {
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

std::string json_pose(const render::Pose& pose) {
  const glm::dvec3& p = pose.position_m;
  const glm::dquat& q = pose.orientation;
  return fmt::format("{{\"position_m\": {}, \"quaternion_xyzw\": {}}}", json_list({p.x, p.y, p.z}),
                     json_list({q.x, q.y, q.z, q.w}));
}

}  // namespace sonard::server
