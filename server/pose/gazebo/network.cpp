// SPDX-License-Identifier: Apache-2.0
#include "server/pose/gazebo/network.hpp"

#include <linux/filter.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "server/error/error.hpp"
#include "server/net/interfaces.hpp"

namespace sonard::server {
namespace {

int option_of(int socket, int option) {
  int value = 0;
  socklen_t size = sizeof(value);
  return getsockopt(socket, SOL_SOCKET, option, &value, &size) == 0 ? value : 0;
}

/// True for a UDP socket on all addresses that shares its port: only Gazebo's library opens such sockets
/// here.
bool receives_discovery(int descriptor) {
  sockaddr_in local{};
  socklen_t size = sizeof(local);
  return option_of(descriptor, SO_TYPE) == SOCK_DGRAM && option_of(descriptor, SO_REUSEPORT) != 0 &&
         getsockname(descriptor, reinterpret_cast<sockaddr*>(&local), &size) == 0 &&
         local.sin_family == AF_INET && local.sin_addr.s_addr == INADDR_ANY && local.sin_port != 0;
}

std::vector<int> discovery_sockets() {
  std::vector<int> sockets;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int descriptor = std::stoi(entry.path().filename());
    if (receives_discovery(descriptor)) {
      sockets.push_back(descriptor);
    }
  }
  return sockets;
}

/// Accepts datagrams from the loopback interface, and multicast that this machine sent on another interface:
/// a simulator here uses another interface unless IGN_IP names an address.
void drop_other_machines(int socket) {
  const auto metadata = [](int field) { return static_cast<std::uint32_t>(SKF_AD_OFF + field); };
  std::array<sock_filter, 6> program{{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, metadata(SKF_AD_IFINDEX)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, if_nametoindex("lo"), 2, 0),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, metadata(SKF_AD_PKTTYPE)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, PACKET_LOOPBACK, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, 0xFFFFFFFF),  // the whole datagram
      BPF_STMT(BPF_RET | BPF_K, 0),
  }};
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  if (setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof(filter)) != 0) {
    throw Error(ErrorKind::network,
                fmt::format("pose gazebo: cannot limit discovery to this machine: {}", std::strerror(errno)),
                "poses");
  }
}

}  // namespace

void set_gazebo_address(Ipv4 address) {
  const std::string text = address_text(address);
  if (const auto own = interface_addresses(); !own.empty() && !owner_of(address, own)) {
    throw Error(ErrorKind::network,
                fmt::format("pose gazebo: {} is not an address of this machine (poses.gazebo.address)", text),
                "poses");
  }
  setenv("IGN_IP", text.c_str(), /*overwrite=*/1);
  setenv("GZ_IP", text.c_str(), /*overwrite=*/1);
}

void keep_gazebo_to_this_machine() {
  for (const int socket : discovery_sockets()) {
    drop_other_machines(socket);
  }
}

}  // namespace sonard::server
