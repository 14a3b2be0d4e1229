// SPDX-License-Identifier: Apache-2.0
// Any bytes as a stream of pose messages, and as one datagram.
// Promises: frames lie inside the bytes and hold their own length; decoded values are finite and bounded, and
// stable under encode and decode.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocol/pose/pose_codec.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace sonard::pose;
using sonard::fuzz::require;

bool finite(const Transform& transform) {
  const auto& p = transform.position_m;
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void check_message(std::span<const std::uint8_t> message) {
  const auto sample = decode(message);
  if (!sample) {
    require(!to_string(sample.error()).empty(), "an error has words");
    return;
  }
  require(std::abs(sample->time_ns) <= max_time_ns, "times are bounded");
  require(finite(sample->T_world_vehicle), "positions are finite");
  for (const NamedTransform& body : sample->bodies) {
    require(!body.name.empty() && finite(body.T_world_body), "bodies have names and finite positions");
    require(!body.twist || (is_finite(body.twist->linear_mps) && is_finite(body.twist->angular_radps)),
            "velocities of bodies are finite");
  }
  const auto again = decode(encode(*sample));
  require(again.has_value(), "what was decoded can be encoded");
  require(again->time_ns == sample->time_ns && again->bodies.size() == sample->bodies.size(),
          "it is the same again");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> rest{data, size};
  check_message(rest);
  while (true) {
    const std::ptrdiff_t length = next_frame(rest);
    if (length <= 0) {
      break;
    }
    const auto whole = static_cast<std::size_t>(length);
    require(whole <= rest.size() && whole <= max_frame_bytes, "a frame lies inside");
    const auto message = frame_message(rest.first(whole));
    require(message.size() < whole && message.data() + message.size() == rest.data() + whole,
            "its message is its end");
    check_message(message);
    rest = rest.subspan(whole);
  }
  return 0;
}
