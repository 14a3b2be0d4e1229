// SPDX-License-Identifier: Apache-2.0
// A head, one client of its HTTP interface, and everything that it sends.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "protocol/sonar3d15/codec.hpp"
#include "protocol/sonar3d15/device.hpp"
#include "protocol/sonar3d15/http.hpp"
#include "tests/support/device_bench.hpp"

namespace sonard::sonar3d15::testing {

inline const std::string integration = "/api/v1/integration/";

/// Eight columns of four rows, so that a shot takes little time.
inline DeviceConfig small(DeviceConfig config = {}) {
  config.columns = 8;
  config.rows = 4;
  return config;
}

class Bench : public DeviceBench {
 public:
  explicit Bench(const DeviceConfig& config = small())
      : DeviceBench(head, [](const PingJob& job) { return test_image(job, job.bins()); }),
        head(config, TimePoint{}) {
    step(ClientCame{client});
  }

  Reply request(const std::string& method, const std::string& path, const std::string& body = "") {
    replies.clear();
    receive(client, encode(Request{method, path.starts_with('/') ? path : integration + path, body}));
    EXPECT_EQ(replies.size(), 1U) << method << " " << path;
    return replies.empty() ? Reply{0, ""} : replies.front();
  }
  std::string get(const std::string& path) {
    const Reply reply = request("GET", path);
    EXPECT_EQ(reply.status, 200) << path;
    return reply.body;
  }
  int post(const std::string& path, const std::string& body) {
    const Reply reply = request("POST", path, body);
    EXPECT_EQ(reply.body.empty(), reply.status == 204) << path << " " << reply.body;
    return reply.status;
  }
  template <class Wanted>
  std::vector<Wanted> images() const {
    std::vector<Wanted> found;
    for (const Message& message : messages) {
      if (const auto* const wanted = std::get_if<Wanted>(&message)) {
        found.push_back(*wanted);
      }
    }
    return found;
  }

  Device head;
  const Peer client{Device::control_channel, {0xC0A80205, 40000}, 0};
  std::vector<Reply> replies;
  std::vector<Message> messages;        ///< on the image channel, in order
  std::vector<Endpoint> destinations;   ///< of the messages
  std::vector<std::uint8_t> recording;  ///< the datagrams, one after another

 protected:
  void hear(const Outgoing& message) override {
    if (message.peer.channel == Device::control_channel) {
      EXPECT_EQ(message.peer, client);
      const auto reply = decode_reply(message.bytes);
      ASSERT_TRUE(reply);
      replies.push_back(*reply);
      return;
    }
    const auto decoded = decode(message.bytes);
    ASSERT_TRUE(decoded) << to_string(decoded.error());
    messages.push_back(*decoded);
    destinations.push_back(message.peer.remote);
    recording.insert(recording.end(), message.bytes.begin(), message.bytes.end());
  }
};

}  // namespace sonard::sonar3d15::testing
