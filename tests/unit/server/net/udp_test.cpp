// SPDX-License-Identifier: Apache-2.0
// A serial line over UDP datagrams.
#include "tests/unit/server/net/link_fixture.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::string name_of(const Client& client) {
  return "udp " + endpoint_text(client.endpoint());
}

TEST_F(LinkTest, UdpRepliesToWhomItHeardLast) {
  open({{}, {any_udp}, {}, 0});
  Client one = udp_client();
  Client two = udp_client();
  one.write(send_version);
  ASSERT_TRUE(run_until_heard(send_version));
  EXPECT_TRUE(link_->connected());
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(one, alive));

  heard_.clear();
  two.write(send_version);
  ASSERT_TRUE(run_until_heard(send_version));
  EXPECT_THAT(left_, ElementsAre(name_of(one))) << "what it had begun will not be finished";
  EXPECT_THAT(peers_, ElementsAre(name_of(one), name_of(two)));
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(two, alive));
  EXPECT_EQ(one.heard(), alive) << "once, and not again";
  EXPECT_EQ(link_->counters().ports.connections, 2U);
}

TEST_F(LinkTest, UdpCarriesExactlyOneFramePerDatagram) {
  open({{}, {any_udp}, {}, 0});
  Client client = udp_client();
  client.write(Bytes{1});
  ASSERT_TRUE(run_until_heard({1}));
  const std::vector<Bytes> frames{alive, numbered_frame(7, 445), numbered_frame(8, 1545)};
  for (const Bytes& frame : frames) {
    link_->send(frame);
  }
  for (const Bytes& frame : frames) {
    ASSERT_TRUE(run_until([&] { return client.readable() > 0; }));
    EXPECT_EQ(client.read_once(), frame);
  }
}

TEST_F(LinkTest, UdpTakesCommandsInAnyPieces) {
  open({{}, {any_udp}, {}, 0});
  Client client = udp_client();
  for (const std::uint8_t byte : send_version) {
    client.write(Bytes{byte});
  }
  EXPECT_TRUE(run_until_heard(send_version));
  EXPECT_THAT(left_, IsEmpty());
}

TEST_F(LinkTest, UdpDiscardsWhatComesBeforeAnybodyWasHeard) {
  open({{}, {any_udp}, {}, 0});
  link_->send(alive);
  EXPECT_EQ(link_->counters().frames_unheard, 1U);
  Client client = udp_client();
  client.write(Bytes{1});
  ASSERT_TRUE(run_until_heard({1}));
  link_->send(numbered_frame(1, 50));
  EXPECT_TRUE(run_until_hears(client, numbered_frame(1, 50)));
}

TEST_F(LinkTest, UdpAnswersFromTheAddressThatWasAsked) {
  open({{}, {{{0, 0}, loopback}}, {}, 0});
  // A connected socket receives only from the address to which it is connected.
  Client client = Client::udp({0x7F000005, link_->addresses().udp.at(0).port});
  client.write(Bytes{1});
  ASSERT_TRUE(run_until_heard({1}));
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(client, alive));
}

TEST_F(LinkTest, UdpServesOnlyWhomItIsAllowedTo) {
  open({{}, {{{localhost, 0}, {{localhost, 32}}}}, {}, 0});
  Client unauthorised = udp_client(0x7F000009);
  unauthorised.write(send_version);
  ASSERT_TRUE(run_until([&] { return link_->counters().ports.refused == 1; }));
  EXPECT_FALSE(link_->connected());
  EXPECT_THAT(heard_, IsEmpty());
}

TEST_F(LinkTest, UdpCountsADatagramLongerThanAnyCommand) {
  open({{}, {any_udp}, {}, 0});
  Client client = udp_client();
  client.write(Bytes(2049));
  ASSERT_TRUE(run_until([&] { return link_->counters().ports.refused == 1; }));
  client.write(Bytes(2048));
  EXPECT_TRUE(run_until_heard(Bytes(2048)));
}

}  // namespace
}  // namespace sonard::server
