// SPDX-License-Identifier: Apache-2.0
// A line that is locked to the first address, with a stepped clock (docs/security.md).
#include "tests/unit/server/net/link_fixture.hpp"

namespace sonard::server {
namespace {

constexpr Ipv4 other_address = 0x7F000003;

class LockedLink : public LinkTest {
 protected:
  LockedLink() { open({{any_tcp}, {any_udp}, {{}}, 0, /*lock_to_first=*/true}, stepped_); }

  bool run_until_locked_out(std::uint64_t count) {
    return run_until([&] { return link_->counters().locked_out == count; });
  }

  SteppedClock stepped_;
};

TEST_F(LockedLink, DropsWhatOthersSendAndLetsThemHear) {
  Client first = tcp_client();
  Client second = tcp_client(other_address);
  Client terminal = tty_client();
  ASSERT_TRUE(run_until_connections(3));
  first.write(Bytes{1});
  ASSERT_TRUE(run_until_heard({1}));
  second.write(Bytes{2});
  ASSERT_TRUE(run_until_locked_out(1));
  terminal.write(Bytes{3});
  ASSERT_TRUE(run_until_locked_out(2));
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(first, alive));
  EXPECT_TRUE(run_until_hears(second, alive));
  EXPECT_TRUE(run_until_hears(terminal, alive));
  EXPECT_EQ(heard_, Bytes{1});
}

TEST_F(LockedLink, DoesNotTurnRepliesOfUdpToOthers) {
  Client first = udp_client();
  first.write(Bytes{1});
  ASSERT_TRUE(run_until_heard({1}));
  Client second = udp_client(other_address);
  second.write(Bytes{2});
  ASSERT_TRUE(run_until_locked_out(1));
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(first, alive));
  EXPECT_TRUE(second.heard().empty());
}

TEST_F(LockedLink, IsFreeWhenTheFirstIsSilentForItsTimeout) {
  Client first = tcp_client();
  Client second = tcp_client(other_address);
  first.write(Bytes{1});
  ASSERT_TRUE(run_until_heard({1}));
  stepped_.time += SerialLink::lock_timeout - TimePoint{1};
  second.write(Bytes{2});
  ASSERT_TRUE(run_until_locked_out(1));
  stepped_.time += TimePoint{1};
  second.write(Bytes{3});
  ASSERT_TRUE(run_until_heard({1, 3}));
  first.write(Bytes{4});
  EXPECT_TRUE(run_until_locked_out(2));
}

TEST_F(LockedLink, HasAllClientsOfOneAddressForOne) {
  Client first = tcp_client();
  first.write(Bytes{1});
  ASSERT_TRUE(run_until_heard({1}));
  first.close();
  Client again = tcp_client();
  again.write(Bytes{2});
  EXPECT_TRUE(run_until_heard({1, 2}));
}

}  // namespace
}  // namespace sonard::server
