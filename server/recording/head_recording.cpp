#include "server/recording/head_recording.hpp"

#include <utility>

#include "server/recording/recorder.hpp"

namespace sonard::server {

template <class What>
void HeadRecording::push(What what) const {
  if (on()) {
    recorder_->push({head_, clock_->now(), std::move(what)});
  }
}

WirePassed passed(std::span<const Datagram> datagrams, bool to_client, const Endpoint& local) {
  WirePassed wire{.to_client = to_client, .transport = WireTransport::udp, .pty = {}, .pieces = {}};
  wire.pieces.reserve(datagrams.size());
  for (const Datagram& datagram : datagrams) {
    const Ipv4 own = datagram.local != 0 ? datagram.local : local.address;
    wire.pieces.push_back({datagram.remote, {own, local.port}, datagram.bytes});
  }
  return wire;
}

void HeadRecording::datagrams(std::span<const Datagram> datagrams, bool to_client,
                              const Endpoint& local) const {
  if (on()) {
    push(passed(datagrams, to_client, local));
  }
}

void HeadRecording::piece(const WireEnds& ends, bool to_client, std::span<const std::uint8_t> bytes) const {
  const gemini::SharedBytes copy(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  push(WirePassed{to_client, ends.transport, ends.pty, {{ends.client, ends.head, copy}}});
}

void HeadRecording::client_left(const WireEnds& ends) const {
  push(ClientLeft{ends});
}

void HeadRecording::gemini_status(const gemini::SharedBytes& datagram) const {
  push(GeminiStatusSent{datagram});
}

void HeadRecording::gemini_ping(GeminiPingServed ping) const {
  push(std::move(ping));
}

void HeadRecording::micron_line(MicronLineSent line) const {
  push(std::move(line));
}

void HeadRecording::posed(const std::shared_ptr<const PosesUsed>& poses) const {
  push(PingPosed{poses});
}

}  // namespace sonard::server
