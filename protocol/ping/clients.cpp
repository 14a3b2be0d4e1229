// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping/clients.hpp"

#include <algorithm>
#include <memory>

namespace sonard::ping {

std::optional<std::string> invalid_field(const ClientsConfig& config) {
  constexpr std::chrono::nanoseconds zero{0};
  if (config.idle_timeout < zero) {
    return "idle_timeout must not be negative";
  }
  if (config.lock_to_first && config.idle_timeout == zero) {
    return "idle_timeout must be positive if lock_to_first is set";
  }
  if (config.max_clients < 2) {
    return "max_clients must be at least 2";
  }
  return std::nullopt;
}

bool Clients::locked_against(TimePoint now, const Peer& peer) {
  if (holder_ && now - holder_->heard >= config_.idle_timeout) {
    holder_.reset();
  }
  if (!config_.lock_to_first || !holder_) {
    return false;
  }
  if (holder_->address == peer.remote.address) {
    holder_->heard = now;
    return false;
  }
  return true;
}

Clients::Client* Clients::find(const Peer& peer) {
  const auto found =
      std::ranges::find_if(clients_, [&](const Client& it) { return same_client(it.peer, peer); });
  return found == clients_.end() ? nullptr : &*found;
}

Clients::Client& Clients::heard(TimePoint now, const Peer& peer,
                                const std::function<bool(const Peer&)>& keeps) {
  Client* client = find(peer);
  if (client == nullptr) {
    if (clients_.size() >= config_.max_clients) {
      clients_.erase(std::ranges::min_element(
          clients_, {}, [&](const Client& it) { return keeps(it.peer) ? TimePoint::max() : it.heard; }));
      ++dropped_;
    }
    client = &clients_.emplace_back(Client{peer, FrameBuffer(config_.max_payload), now});
  }
  client->peer = peer;  // the client may use another of our addresses than before
  client->heard = now;
  return *client;
}

bool Clients::can_fall_silent(const Client& client) const {
  return config_.idle_timeout.count() > 0 && !is_serial(client.peer);
}

std::vector<Peer> Clients::silent(TimePoint now) const {
  std::vector<Peer> found;
  for (const Client& client : clients_) {
    if (can_fall_silent(client) && now - client.heard >= config_.idle_timeout) {
      found.push_back(client.peer);
    }
  }
  return found;
}

std::optional<TimePoint> Clients::next_silence() const {
  std::optional<TimePoint> next;
  for (const Client& client : clients_) {
    if (can_fall_silent(client)) {
      const TimePoint due = client.heard + config_.idle_timeout;
      next = std::min(next.value_or(due), due);
    }
  }
  return next;
}

void Clients::remove(const Peer& peer) {
  std::erase_if(clients_, [&](const Client& it) { return same_client(it.peer, peer); });
}

void Clients::clear() {
  clients_.clear();
  holder_.reset();
}

std::string Clients::name_of(const Peer& peer) const {
  return is_serial(peer) ? "on the serial line" : endpoint_text(peer.remote);
}

void Clients::send(const Peer& to, const std::vector<std::uint8_t>& frame, std::vector<Outgoing>& out) const {
  if (config_.fan_out == FanOut::requester) {
    send_to(to, frame, out);
    return;
  }
  for (const Client& client : clients_) {
    send_to(client.peer, frame, out);
  }
}

void Clients::send_to(const Peer& to, const std::vector<std::uint8_t>& frame,
                      std::vector<Outgoing>& out) const {
  const auto shared = std::make_shared<const std::vector<std::uint8_t>>(frame);
  const std::size_t most = config_.max_datagram > 0 ? config_.max_datagram : frame.size();
  for (std::size_t begin = 0; begin < frame.size(); begin += most) {
    out.push_back({Outgoing::To::peer, to, SharedBytes(shared, begin, std::min(most, frame.size() - begin))});
  }
}

}  // namespace sonard::ping
