// SPDX-License-Identifier: Apache-2.0
// Any stream against the client's side of an Oculus, in one piece and byte by byte.
// Promises: messages and pings do not depend on the pieces; every ping has all its samples.
#include <span>

#include "protocol/oculus/client.hpp"
#include "protocol/oculus/image_form.hpp"
#include "protocol/oculus/recorded_form.hpp"
#include "tests/fuzz/require.hpp"

using sonard::fuzz::require;
using namespace sonard::oculus;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> stream{data, size};
  Client whole;
  whole.receive({}, stream);
  Client pieces;
  for (std::size_t at = 0; at < size; ++at) {
    pieces.receive({}, stream.subspan(at, 1));
  }
  require(whole.statistics().messages == pieces.statistics().messages, "as many messages");
  require(whole.statistics().bad_messages == pieces.statistics().bad_messages, "as many bad ones");
  require(whole.statistics().dropped_bytes == pieces.statistics().dropped_bytes, "as many bytes between");
  require(whole.take_logs() == pieces.take_logs(), "the same words");
  const std::vector<ReceivedPing> pings = whole.take_pings();
  require(pings.size() == pieces.take_pings().size(), "as many pings");
  for (const ReceivedPing& ping : pings) {
    require(eight_bit_samples(ping.result).size() == std::size_t{ping.result.ranges} * ping.result.beams,
            "a ping has all its samples");
    static_cast<void>(recorded_form(ping.message));
  }
  return 0;
}
