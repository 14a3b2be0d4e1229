// SPDX-License-Identifier: Apache-2.0
#include "server/pose/udp/input.hpp"

#include <utility>

#include "server/pose/udp/source.hpp"
#include "server/yaml/network_section.hpp"

namespace sonard::server {
namespace {

class UdpInput final : public PoseInputWith<UdpPoseInput> {
 public:
  explicit UdpInput(UdpPoseInput values) : PoseInputWith(udp_pose_source_type(), std::move(values)) {}

  std::string summary() const override { return "UDP " + endpoint_text(settings.bind); }
  std::optional<PlannedSocket> socket() const override {
    return PlannedSocket{PlannedSocket::Transport::udp, settings.bind, "poses.udp.bind"};
  }
  std::unique_ptr<PoseSource> open(boost::asio::io_context& io, const Clock& clock, PoseSink sink,
                                   PoseHold /*hold*/) const override {
    return std::make_unique<UdpPoseSource>(io, settings, clock, std::move(sink));
  }
};

std::shared_ptr<const PoseInput> read_udp(YamlSection& section, const std::filesystem::path& /*folder*/) {
  UdpPoseInput udp;
  read_socket(section, udp.bind, udp.allow, endpoint_form,
              "UDP address that receives poses; the demo uses 127.0.0.1:14600",
              "address blocks that may publish poses");
  return pose_input(std::move(udp));
}

}  // namespace

std::shared_ptr<const PoseInput> pose_input(UdpPoseInput settings) {
  return std::make_shared<UdpInput>(std::move(settings));
}

const PoseSourceType& udp_pose_source_type() {
  static const PoseSourceType type{.key = "udp",
                                   .meaning = "pose messages by UDP, one per datagram ([poses.md](poses.md))",
                                   .read = &read_udp};
  return type;
}

}  // namespace sonard::server
