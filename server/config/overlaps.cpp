#include "server/config/overlaps.hpp"

#include <string>
#include <string_view>

#include <fmt/format.h>

#include "server/config/addresses.hpp"

namespace sonard::server {
namespace {

bool clash(const Endpoint& one, const Endpoint& other) {
  const bool share_address = one.address == other.address || one.address == 0 || other.address == 0;
  return share_address && one.port != 0 && one.port == other.port;
}

}  // namespace

std::vector<PlannedSocket> planned_udp_sockets(const DaemonConfig& config) {
  std::vector<PlannedSocket> sockets;
  if (config.poses.udp) {
    sockets.push_back({config.poses.udp->bind, "poses.udp.bind"});
  }
  for (std::size_t i = 0; i < config.heads.size(); ++i) {
    const GeminiHeadConfig& head = config.heads[i];
    sockets.push_back({{head.bind_address, head.command_port}, fmt::format("heads[{}].network.bind", i)});
    if (head.trigger) {
      sockets.push_back({*head.trigger, fmt::format("heads[{}].trigger.bind", i)});
    }
  }
  return sockets;
}

std::vector<ConfigProblem> find_overlaps(const DaemonConfig& config, const KeyPositions& positions) {
  std::vector<ConfigProblem> problems;
  const auto report = [&](const std::string& key, std::string message) {
    problems.push_back({nearest_position(positions, key), key, std::move(message)});
  };

  const std::vector<PlannedSocket> sockets = planned_udp_sockets(config);
  for (std::size_t i = 0; i < sockets.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (clash(sockets[i].endpoint, sockets[j].endpoint)) {
        report(sockets[i].key, fmt::format("UDP {} overlaps {} of {} (expected a socket of its own)",
                                           endpoint_text(sockets[i].endpoint),
                                           endpoint_text(sockets[j].endpoint), sockets[j].key));
      }
    }
  }

  const auto report_twice = [&](std::size_t head, std::size_t other, std::string_view key,
                                const std::string& value) {
    report(fmt::format("heads[{}].{}", head, key),
           fmt::format("{} already belongs to heads[{}] (expected one of its own)", value, other));
  };
  for (std::size_t i = 0; i < config.heads.size(); ++i) {
    const GeminiHeadConfig& head = config.heads[i];
    for (std::size_t j = 0; j < i; ++j) {
      const GeminiHeadConfig& other = config.heads[j];
      if (head.name == other.name) {
        report_twice(i, j, "name", fmt::format("'{}'", head.name));
      }
      if (head.device.sonar_id == other.device.sonar_id) {
        report_twice(i, j, "sonar_id", std::to_string(head.device.sonar_id));
      }
      if (head.device.alternate_address == other.device.alternate_address) {
        report_twice(i, j, "network.alternate_address", address_text(head.device.alternate_address));
      }
    }
  }
  return problems;
}

}  // namespace sonard::server
