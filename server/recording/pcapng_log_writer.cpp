// SPDX-License-Identifier: Apache-2.0
#include "server/recording/pcapng_log_writer.hpp"

#include <variant>

#include "server/recording/log_names.hpp"

namespace sonard::server {
namespace {

pcapng::Endpoint end_of(const Endpoint& endpoint) {
  return {endpoint.address, endpoint.port};
}

pcapng::ByteView view(const SharedBytes& bytes) {
  return {bytes.data(), bytes.size()};
}

}  // namespace

PcapngLogWriter::PcapngLogWriter(const LogSetting& setting)
    : LogWriter(setting), writer_("sonard " SONARD_VERSION) {
  for (const HeadToRecord& head : setting.heads) {
    writer_.add_interface(head.name);  // interface numbers are head indices
  }
}

void PcapngLogWriter::write(const RecordingEvent& event) {
  if (file().failed()) {
    return;
  }
  if (const auto* wire = std::get_if<WirePassed>(&event.what)) {
    if (!file().begun()) {
      file().begin(pcapng_path(setting().config.directory, setting().stem));
    }
    wire->transport == WireTransport::udp ? write_datagrams(event, *wire) : write_stream(event, *wire);
  } else if (const auto* left = std::get_if<StreamEnded>(&event.what)) {
    end_stream(event, left->ends);
  }
}

void PcapngLogWriter::write_datagrams(const RecordingEvent& event, const WirePassed& wire) {
  for (const WirePiece& piece : wire.pieces) {
    const pcapng::Endpoint client = end_of(piece.client);
    const pcapng::Endpoint head = end_of(piece.head);
    add(event, {wire.to_client ? pcapng::udp_packet(head, client, view(piece.bytes))
                               : pcapng::udp_packet(client, head, view(piece.bytes))});
  }
}

void PcapngLogWriter::write_stream(const RecordingEvent& event, const WirePassed& wire) {
  const bool pty = wire.transport == WireTransport::pty;
  for (const WirePiece& piece : wire.pieces) {
    const StreamKey key{event.head, piece.client.address, piece.client.port, wire.pty};
    auto stream = streams_.find(key);
    if (stream == streams_.end()) {
      stream = streams_
                   .emplace(key, pcapng::TcpConversation(pty ? pcapng::serial_client : end_of(piece.client),
                                                         pty ? pcapng::serial_head : end_of(piece.head)))
                   .first;
      add(event, stream->second.open());
    }
    add(event, wire.to_client ? stream->second.from_server(view(piece.bytes))
                              : stream->second.from_client(view(piece.bytes)));
  }
}

void PcapngLogWriter::end_stream(const RecordingEvent& event, const WireEnds& ends) {
  const auto stream = streams_.find({event.head, ends.client.address, ends.client.port, ends.pty});
  if (stream != streams_.end()) {
    add(event, stream->second.close());
    streams_.erase(stream);
  }
}

void PcapngLogWriter::add(const RecordingEvent& event, const std::vector<pcapng::Bytes>& packets) {
  for (const pcapng::Bytes& packet : packets) {
    writer_.add_packet(static_cast<std::uint32_t>(event.head),
                       static_cast<std::uint64_t>(setting().unix_ns(event.time)), packet);
  }
}

void PcapngLogWriter::flush(TimePoint) {
  if (file().begun()) {  // the writer's first data is the start of the file and waits for begin()
    file().append(writer_.take());
  }
}

void PcapngLogWriter::close() {
  flush({});
  file().end();
}

}  // namespace sonard::server
