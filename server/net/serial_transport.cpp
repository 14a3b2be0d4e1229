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
  return serial_counters(link_.counters());
}

std::vector<Counter> serial_counters(const SerialLinkCounters& link) {
  using Fault = Counter::Fault;
  using Shown = Counter::Shown;
  const SerialPortCounters& ports = link.ports;
  std::vector<Counter> counts{
      {"connections", ports.connections, "connections of clients"},
      {"refused", ports.refused, "clients or datagrams refused: not in `allow`, too many, or too long",
       Fault::none, Shown::warns,
       "{} clients or datagrams were refused: not in `allow`, too many, or too long"},
      {"locked_out", link.locked_out, "reads of other clients, dropped (`lock_to_first`)", Fault::none,
       Shown::warns, "{} reads were dropped: another client has the line (lock_to_first)"},
      {"bytes_in", ports.bytes_in, "bytes from clients"},
      {"bytes_out", ports.bytes_out, "bytes to clients; to two clients, they count twice"},
      {"frames_dropped", ports.frames_dropped,
       "frames dropped: a client reads too slowly; a warning names the port"},
      {"frames_lost", ports.frames_lost, "frames lost: the other end was gone"},
      {"frames_unheard", link.frames_unheard, "frames dropped: no client was connected"}};
  for (const SerialPortReport& port : link.each) {
    counts.push_back({"", port.counters.frames_dropped, "", Fault::none, Shown::warns,
                      port.description + ": {} frames were dropped: a client reads too slowly"});
  }
  return counts;
}

}  // namespace sonard::server
