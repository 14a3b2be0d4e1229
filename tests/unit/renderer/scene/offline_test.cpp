// SPDX-License-Identifier: Apache-2.0
// A mesh may refer to files on servers. Loading it must not open a connection.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "renderer/scene/mesh_file.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

/// Listens on a loopback port of the kernel's choice.
class Listener {
 public:
  Listener() : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* any = reinterpret_cast<sockaddr*>(&address);
    if (fd_ < 0 || ::bind(fd_, any, size) != 0 || ::listen(fd_, 4) != 0 ||
        ::getsockname(fd_, any, &size) != 0) {
      throw std::runtime_error("no loopback port");
    }
    url_ = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  }
  ~Listener() { ::close(fd_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  const std::string& url() const { return url_; }
  bool was_called() const {
    pollfd waiting{fd_, POLLIN, 0};
    return ::poll(&waiting, 1, 0) > 0;
  }

 private:
  int fd_;
  std::string url_;
};

TEST(Offline, AnObjWithATextureOnAServer) {
  const Listener server;
  const test::TempFolder folder;
  folder.write("a.mtl", "newmtl steel\nKd 1 1 1\nmap_Kd " + server.url() + "/paint.png\n");
  MeshFileRequest request;
  request.file = folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl steel\nf 1 2 3\n");
  EXPECT_EQ(load_mesh_file(request).parts.size(), 1U);
  EXPECT_FALSE(server.was_called());
}

TEST(Offline, AnOsgFileThatPointsToAServer) {
  const Listener server;
  const test::TempFolder folder;
  MeshFileRequest request;
  request.file =
      folder.write("a.osgt",
                   "#Ascii Scene \n#Version 161 \n#Generator OpenSceneGraph 3.6.5 \n\nosg::ProxyNode {\n"
                   "  UniqueID 1 \n  FileNames 1 {\n    \"" +
                       server.url() + "/a.osgt\" \n  }\n}\n");
  EXPECT_THROW(load_mesh_file(request), WorldError);
  EXPECT_FALSE(server.was_called());
}

TEST(Offline, AMeshOnAServer) {
  const Listener server;
  MeshFileRequest request;
  request.file = server.url() + "/a.obj";
  EXPECT_THROW(load_mesh_file(request), WorldError);
  EXPECT_FALSE(server.was_called());
}

}  // namespace
}  // namespace sonard::render
