// SPDX-License-Identifier: Apache-2.0
#include "server/config/overlaps.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "server/pose/pose_input.hpp"

namespace sonard::server {
namespace {

using Transport = PlannedSocket::Transport;

bool clash(const PlannedSocket& one, const PlannedSocket& other) {
  const Endpoint& a = one.endpoint;
  const Endpoint& b = other.endpoint;
  const bool share_address = a.address == b.address || a.address == 0 || b.address == 0;
  return one.transport == other.transport && share_address && a.port != 0 && a.port == b.port;
}

std::string head_key(std::size_t head, std::string_view key) {
  return fmt::format("heads[{}].{}", head, key);
}

/// Values that the configuration gives to two of its parts.
class Overlaps {
 public:
  Overlaps(const DaemonConfig& config, const KeyPositions& positions)
      : config_(config), positions_(positions) {}

  std::vector<ConfigProblem> find() {
    find_clashes(planned_sockets(config_));
    for (std::size_t i = 0; i < config_.heads.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        compare_heads(i, j);
      }
    }
    return std::move(problems_);
  }

 private:
  void report(const std::string& key, std::string message) {
    problems_.push_back({nearest_position(positions_, key), key, std::move(message)});
  }

  void find_clashes(const std::vector<PlannedSocket>& sockets) {
    for (std::size_t i = 0; i < sockets.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (clash(sockets[i], sockets[j])) {
          report(sockets[i].key, fmt::format("{} {} overlaps {} of {} (expected a socket of its own)",
                                             sockets[i].transport == Transport::udp ? "UDP" : "TCP",
                                             endpoint_text(sockets[i].endpoint),
                                             endpoint_text(sockets[j].endpoint), sockets[j].key));
        }
      }
    }
  }

  void compare_heads(std::size_t i, std::size_t j) {
    const HeadConfig& head = config_.heads[i];
    const HeadConfig& other = config_.heads[j];
    compare(i, {"name", fmt::format("'{}'", head.name)}, j, {"name", fmt::format("'{}'", other.name)});
    for (const Identity& identity : head.type->identities(head)) {
      for (const Identity& taken : other.type->identities(other)) {
        if (head.type == other.type || !identity.of_type) {
          compare(i, identity, j, taken);
        }
      }
    }
  }

  void compare(std::size_t head, const Identity& identity, std::size_t other, const Identity& taken) {
    if (identity.key == taken.key && identity.value == taken.value) {
      report(head_key(head, identity.key),
             fmt::format("{} is already used by heads[{}] (expected a unique value)", identity.value, other));
    }
  }

  const DaemonConfig& config_;
  const KeyPositions& positions_;
  std::vector<ConfigProblem> problems_;
};

}  // namespace

std::vector<PlannedSocket> planned_sockets(const DaemonConfig& config) {
  std::vector<PlannedSocket> sockets;
  for (const std::shared_ptr<const PoseInput>& input : config.poses.inputs) {
    if (std::optional<PlannedSocket> socket = input->socket()) {
      sockets.push_back(std::move(*socket));
    }
  }
  if (config.web) {
    sockets.push_back({Transport::tcp, config.web->bind, "web.bind"});
  }
  for (std::size_t i = 0; i < config.heads.size(); ++i) {
    for (PlannedSocket socket : config.heads[i].type->sockets(config.heads[i])) {
      socket.key = head_key(i, socket.key);
      sockets.push_back(std::move(socket));
    }
  }
  return sockets;
}

std::vector<ConfigProblem> find_overlaps(const DaemonConfig& config, const KeyPositions& positions) {
  return Overlaps(config, positions).find();
}

}  // namespace sonard::server
