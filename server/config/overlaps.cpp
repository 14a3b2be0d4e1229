#include "server/config/overlaps.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <variant>

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
  if (config.poses.mavlink) {
    sockets.push_back({config.poses.mavlink->bind, "poses.mavlink.bind"});
  }
  for (std::size_t i = 0; i < config.heads.size(); ++i) {
    if (const auto* gemini = std::get_if<GeminiHeadConfig>(&config.heads[i])) {
      sockets.push_back(
          {{gemini->bind_address, gemini->command_port}, fmt::format("heads[{}].network.bind", i)});
      if (gemini->trigger) {
        sockets.push_back({*gemini->trigger, fmt::format("heads[{}].trigger.bind", i)});
      }
    } else if (const auto* micron = std::get_if<MicronHeadConfig>(&config.heads[i])) {
      for (std::size_t k = 0; k < micron->serial.udp.size(); ++k) {
        sockets.push_back({micron->serial.udp[k].bind, fmt::format("heads[{}].serial.udp[{}].bind", i, k)});
      }
    }
  }
  return sockets;
}

std::vector<PlannedSocket> planned_tcp_sockets(const DaemonConfig& config) {
  std::vector<PlannedSocket> sockets;
  if (config.poses.tcp) {
    sockets.push_back({config.poses.tcp->bind, "poses.tcp.bind"});
  }
  for (std::size_t i = 0; i < config.heads.size(); ++i) {
    if (const auto* micron = std::get_if<MicronHeadConfig>(&config.heads[i])) {
      for (std::size_t k = 0; k < micron->serial.tcp.size(); ++k) {
        sockets.push_back({micron->serial.tcp[k].bind, fmt::format("heads[{}].serial.tcp[{}].bind", i, k)});
      }
    }
  }
  return sockets;
}

namespace {

/// What the configuration gives to two of its parts.
class Overlaps {
 public:
  Overlaps(const DaemonConfig& config, const KeyPositions& positions)
      : config_(config), positions_(positions) {}

  std::vector<ConfigProblem> find() {
    find_clashes("UDP", planned_udp_sockets(config_));
    find_clashes("TCP", planned_tcp_sockets(config_));
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
  void report_twice(std::size_t head, std::size_t other, std::string_view key, const std::string& value) {
    report(fmt::format("heads[{}].{}", head, key),
           fmt::format("{} already belongs to heads[{}] (expected one of its own)", value, other));
  }

  void find_clashes(std::string_view transport, const std::vector<PlannedSocket>& sockets) {
    for (std::size_t i = 0; i < sockets.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (clash(sockets[i].endpoint, sockets[j].endpoint)) {
          report(sockets[i].key, fmt::format("{} {} overlaps {} of {} (expected a socket of its own)",
                                             transport, endpoint_text(sockets[i].endpoint),
                                             endpoint_text(sockets[j].endpoint), sockets[j].key));
        }
      }
    }
  }

  void compare_heads(std::size_t i, std::size_t j) {
    if (common(config_.heads[i]).name == common(config_.heads[j]).name) {
      report_twice(i, j, "name", fmt::format("'{}'", common(config_.heads[i]).name));
    }
    const auto* gemini = std::get_if<GeminiHeadConfig>(&config_.heads[i]);
    const auto* other_gemini = std::get_if<GeminiHeadConfig>(&config_.heads[j]);
    if (gemini != nullptr && other_gemini != nullptr) {
      compare(i, *gemini, j, *other_gemini);
    }
    const auto* micron = std::get_if<MicronHeadConfig>(&config_.heads[i]);
    const auto* other_micron = std::get_if<MicronHeadConfig>(&config_.heads[j]);
    if (micron != nullptr && other_micron != nullptr) {
      compare(i, *micron, j, *other_micron);
    }
  }

  void compare(std::size_t i, const GeminiHeadConfig& head, std::size_t j, const GeminiHeadConfig& other) {
    if (head.device.sonar_id == other.device.sonar_id) {
      report_twice(i, j, "sonar_id", std::to_string(head.device.sonar_id));
    }
    if (head.device.alternate_address == other.device.alternate_address) {
      report_twice(i, j, "network.alternate_address", address_text(head.device.alternate_address));
    }
  }

  void compare(std::size_t i, const MicronHeadConfig& head, std::size_t j, const MicronHeadConfig& other) {
    for (const SerialPtyConfig& pty : head.serial.pty) {
      for (const SerialPtyConfig& taken : other.serial.pty) {
        if (!pty.link.empty() && pty.link == taken.link) {
          report_twice(i, j, "serial.pty", "'" + pty.link.string() + "'");
        }
      }
    }
  }

  const DaemonConfig& config_;
  const KeyPositions& positions_;
  std::vector<ConfigProblem> problems_;
};

}  // namespace

std::vector<ConfigProblem> find_overlaps(const DaemonConfig& config, const KeyPositions& positions) {
  return Overlaps(config, positions).find();
}

}  // namespace sonard::server
