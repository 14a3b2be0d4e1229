// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping/head.hpp"

#include <utility>
#include <variant>

#include <fmt/format.h>

#include "protocol/ping/codec.hpp"
#include "protocol/ping/layout.hpp"

namespace sonard::ping {

void Head::receive(TimePoint now, const BytesReceived& piece) {
  if (now < silent_until_) {
    counts_.unheard_bytes += piece.bytes.size();
    return;
  }
  if (clients_.locked_against(now, piece.from)) {
    ++counts_.locked_out;
    return;
  }
  if (clients_.find(piece.from) == nullptr) {
    notice(fmt::format("client {} connected", clients_.name_of(piece.from)));
  }
  on_bytes(now);
  Clients::Client& client =
      clients_.heard(now, piece.from, [this](const Peer& known) { return keeps(known); });
  counts_.clients_dropped = clients_.dropped();
  if (piece.bytes.size() > 0 || !on_empty(now, client)) {
    client.input.append(now, {piece.bytes.data(), piece.bytes.size()});
    read(now, client);
  }
  if (now < silent_until_) {
    clients_.clear();  // not earlier, because the input of one was being read
  }
}

void Head::read(TimePoint now, Clients::Client& client) {
  const std::uint64_t dropped = client.input.dropped();
  const std::uint64_t bad_checksums = client.input.bad_checksums();
  for (auto frame = client.input.front(); frame && now >= silent_until_; frame = client.input.front()) {
    between_frames(now, client);
    take_frame(now, client.peer, *frame);
    client.input.pop();
  }
  between_frames(now, client);
  counts_.dropped_bytes += client.input.dropped() - dropped;
  counts_.bad_checksums += client.input.bad_checksums() - bad_checksums;
}

void Head::take_frame(TimePoint now, const Peer& asker, std::span<const std::uint8_t> frame) {
  const FrameHeader header = frame_header(frame);
  if (!any_destination_ && header.destination != 0 && header.destination != broadcast_id &&
      header.destination != id_) {
    ++counts_.other_destinations;
  } else if (!obey(now, asker, frame)) {
    refuse(asker, header.message_id, "wrong payload length");
  }
}

void Head::ack(const Peer& asker, std::uint16_t id) {
  send(asker, encode_frame<CommonLayout>(std::variant<Ack>{Ack{id}}, id_, client_id));
}

void Head::nack(const Peer& asker, std::uint16_t id, std::string_view text) {
  ++counts_.refused;
  send(asker, encode_frame<CommonLayout>(std::variant<Nack>{Nack{id, std::string(text)}}, id_, client_id));
}

void Head::refuse(const Peer& asker, std::uint16_t id, std::string_view text) {
  warnings_.warn(text, fmt::format("the client's message {} is refused: {}", id, text), notices_);
  nack(asker, id, text);
}

void Head::refuse(const Peer& asker, std::uint16_t id, std::string_view field, std::int64_t value,
                  std::int64_t least, std::int64_t most) {
  warnings_.warn(field,
                 fmt::format("the client's {} {} is refused: expected {} to {}", field, value, least, most),
                 notices_);
  nack(asker, id, fmt::format("{} out of range", field));
}

void Head::take(TimePoint now, const ClientGone& gone) {
  if (const Clients::Client* const client = clients_.find(gone.who)) {
    forget(now, Peer{client->peer}, "disconnected");
  }
}

void Head::forget(TimePoint now, const Peer& peer, std::string_view why) {
  on_forget(now, peer, why);
  clients_.remove(peer);
  notice(fmt::format("client {} is gone: {}", clients_.name_of(peer), why));
}

void Head::forget_silent(TimePoint now) {
  for (const Peer& peer : clients_.silent(now)) {
    forget(now, peer, "timed out");
  }
}

void Head::report(Actions& actions) {
  actions.send = std::exchange(outgoing_, {});
  actions.notices = std::exchange(notices_, {});
  actions.nobody_there = clients_.empty();
}

}  // namespace sonard::ping
