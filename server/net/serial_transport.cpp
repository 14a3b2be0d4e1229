// SPDX-License-Identifier: Apache-2.0
#include "server/net/serial_transport.hpp"

#include <utility>

namespace sonard::server {

void SerialTransport::start(TransportEvents events) {
  decltype(SerialPortEvents::passed) passed;
  if (events.passed) {
    passed = [to = events.passed](const WireEnds& ends, bool to_client, std::span<const std::uint8_t> bytes) {
      const SharedBytes copy(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
      to({to_client, ends.transport, ends.pty, {{ends.client, ends.head, copy}}});
    };
  }
  link_.start(
      [to = std::move(events.received)](std::span<const std::uint8_t> bytes, const std::string&) {
        to({{}, SharedBytes(std::vector<std::uint8_t>(bytes.begin(), bytes.end()))});
      },
      [to = std::move(events.gone)](const std::string&) { to({}); }, std::move(passed),
      std::move(events.ended));
}

void SerialTransport::send(std::vector<Outgoing> messages) {
  for (const Outgoing& message : messages) {
    link_.send({message.bytes.begin(), message.bytes.end()});
  }
}

std::vector<Counter> SerialTransport::counts() const {
  using Shown = Counter::Shown;
  const SerialLinkCounters link = link_.counters();
  const SerialPortCounters& ports = link.ports;
  std::vector<Counter> counts{{"connections", ports.connections},
                              {"refused", ports.refused, Shown::warns,
                               "{} clients or datagrams were refused: not in `allow`, too many, or too long"},
                              {"locked_out", link.locked_out, Shown::warns,
                               "{} reads were dropped: another client has the line (lock_to_first)"},
                              {"bytes_in", ports.bytes_in},
                              {"bytes_out", ports.bytes_out},
                              {"frames_dropped", ports.frames_dropped},
                              {"frames_lost", ports.frames_lost},
                              {"frames_unheard", link.frames_unheard}};
  for (const SerialPortReport& port : link.each) {
    counts.push_back({"", port.counters.frames_dropped, Shown::warns,
                      port.description + ": {} frames were dropped: a client reads too slowly"});
  }
  return counts;
}

}  // namespace sonard::server
