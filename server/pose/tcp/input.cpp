// SPDX-License-Identifier: Apache-2.0
#include "server/pose/tcp/input.hpp"

#include <utility>

#include "server/pose/tcp/source.hpp"
#include "server/yaml/network_section.hpp"

namespace sonard::server {
namespace {

class TcpInput final : public PoseInputWith<TcpPoseInput> {
 public:
  explicit TcpInput(TcpPoseInput values) : PoseInputWith(tcp_pose_source_type(), std::move(values)) {}

  std::string summary() const override { return "TCP " + endpoint_text(settings.bind); }
  std::optional<PlannedSocket> socket() const override {
    return PlannedSocket{PlannedSocket::Transport::tcp, settings.bind, "poses.tcp.bind"};
  }
  std::unique_ptr<PoseSource> open(boost::asio::io_context& io, const Clock& clock, PoseSink sink,
                                   PoseHold hold) const override {
    return std::make_unique<TcpPoseSource>(io, settings, clock, std::move(sink), std::move(hold));
  }
};

std::shared_ptr<const PoseInput> read_tcp(YamlSection& section, const std::filesystem::path& /*folder*/) {
  TcpPoseInput tcp;
  read_socket(section, tcp.bind, tcp.allow, endpoint_form, "TCP address that publishers connect to",
              "address blocks that may publish poses");
  section.integer("max_clients", tcp.max_clients, 1, 1000,
                  "maximum number of connections ([beyond it](security.md#limits-on-clients))");
  return pose_input(std::move(tcp));
}

}  // namespace

std::shared_ptr<const PoseInput> pose_input(TcpPoseInput settings) {
  return std::make_shared<TcpInput>(std::move(settings));
}

const PoseSourceType& tcp_pose_source_type() {
  static const PoseSourceType type{.key = "tcp",
                                   .meaning = "varint-delimited pose messages by TCP ([poses.md](poses.md))",
                                   .read = &read_tcp};
  return type;
}

}  // namespace sonard::server
