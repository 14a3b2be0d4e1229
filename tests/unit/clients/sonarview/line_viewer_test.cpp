// SPDX-License-Identifier: Apache-2.0
// How a viewer ends in each fault of its line, against a server on its own thread that sends single bytes.
#include "clients/sonarview/common/line_viewer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <optional>
#include <string>

namespace sonard::client {
namespace {

using namespace std::chrono_literals;
using boost::asio::ip::tcp;
using testing::HasSubstr;

/// Behaviour of the server towards its clients.
struct Server {
  bool there = true;          ///< false: the port is closed
  std::size_t bytes = 3;      ///< number of bytes sent to each client
  bool closes = false;        ///< closes the connection after these bytes
  bool leaves = false;        ///< also closes the port
  bool says_goodbye = false;  ///< answers a goodbye with one byte
};

/// A viewer for which each byte is a ping. The first byte also shows that the head is there.
class Bytes final : public LineViewer {
 public:
  Bytes(const RunOptions& options, Server server)
      : LineViewer(options), server_(server), wanted_(options.pings) {
    if (!server_.there) {
      acceptor_.close();
    } else {
      accept();
    }
  }

  ExitStatus run_quietly() {
    testing::internal::CaptureStderr();
    const ExitStatus status = run();
    said = testing::internal::GetCapturedStderr();
    return status;
  }

  std::string said;
  std::optional<RunCounters> counters;
  int goodbyes = 0;
  std::chrono::nanoseconds patience{};
  bool met_without_a_word = false;

 private:
  void begin(TimePoint) override {
    open_line({.way = LineAddress::Way::tcp, .place = "127.0.0.1", .port = port_});
  }
  void on_bytes(TimePoint at, std::span<const std::uint8_t> bytes) override {
    come_ += bytes.size();
    last_ = at;
  }
  bool head_met() const override { return come_ > 0 || (met_without_a_word && line_is_open()); }
  void take_received() override {
    for (; pings() < come_ && !finished();) {
      count_ping(last_);
    }
  }
  bool finished() const override {
    return goodbyes > 0 ? come_ > at_goodbye_ : wanted_ > 0 && pings() >= wanted_;
  }
  std::chrono::nanoseconds say_goodbye(TimePoint) override {
    ++goodbyes;
    at_goodbye_ = come_;
    if (server_.says_goodbye) {
      boost::asio::write(*peer_, boost::asio::buffer("!", 1));
    }
    return patience;
  }
  void refresh_pictures(ImageWriter&) override {}
  void finish_pictures(ImageWriter&) override {}
  std::string progress_text(std::uint64_t) const override { return "going on"; }
  std::string awaited_text() const override { return "bytes of port " + std::to_string(port_); }
  std::string no_head_text(double) const override { return "open, and silent"; }
  std::string no_ping_text(double) const override { return "no more pings"; }
  bool sum_up(const RunCounters& all) override {
    counters = all;
    return all.pings > 0;
  }

  void accept() {
    acceptor_.async_accept([this](const boost::system::error_code& error, tcp::socket socket) {
      if (error) {
        return;
      }
      peer_ = std::move(socket);
      boost::asio::write(*peer_, boost::asio::buffer(std::string(server_.bytes, '.')));
      if (server_.closes) {
        peer_->close();
      }
      if (server_.leaves) {
        acceptor_.close();
      } else {
        accept();
      }
    });
  }

  const Server server_;
  const std::uint64_t wanted_;
  tcp::acceptor acceptor_{io(), {boost::asio::ip::address_v4::loopback(), 0}};
  const std::uint16_t port_ = acceptor_.local_endpoint().port();
  std::optional<tcp::socket> peer_;
  std::uint64_t come_ = 0;
  std::uint64_t at_goodbye_ = 0;
  TimePoint last_{};
};

RunOptions options() {
  RunOptions options;
  options.wait = 300ms;
  options.quiet = true;
  return options;
}

TEST(LineViewer, ALineThatCannotBeOpenedHasNoHead) {
  Bytes viewer(options(), {.there = false});
  EXPECT_EQ(viewer.run_quietly(), ExitStatus::no_head);
  EXPECT_THAT(viewer.said, HasSubstr("within 0.3 s: Connection refused"));
  EXPECT_EQ(viewer.counters->pings, 0U);
}

TEST(LineViewer, AnOpenLineWithoutAWordHasNoHead) {
  Bytes viewer(options(), {.bytes = 0});
  EXPECT_EQ(viewer.run_quietly(), ExitStatus::no_head);
  EXPECT_THAT(viewer.said, HasSubstr("open, and silent"));
}

TEST(LineViewer, ALineThatIsLostIsOpenedAgainAndCounted) {
  RunOptions run = options();
  run.wait = 30s;
  run.pings = 6;
  Bytes viewer(run, {.closes = true});
  EXPECT_EQ(viewer.run_quietly(), ExitStatus::ok);
  EXPECT_EQ(viewer.counters->pings, 6U);
  EXPECT_EQ(viewer.counters->reconnects, 1U);
  EXPECT_THAT(viewer.said, HasSubstr("closed by the other end; retrying for 30.0 s"));
  EXPECT_THAT(viewer.said, HasSubstr("is open again"));
}

TEST(LineViewer, ALineThatDoesNotComeBackLeavesTheRunIncomplete) {
  Bytes viewer(options(), {.closes = true, .leaves = true});
  EXPECT_EQ(viewer.run_quietly(), ExitStatus::incomplete);
  EXPECT_THAT(viewer.said, HasSubstr("did not open again within 0.3 s"));
  EXPECT_EQ(viewer.counters->pings, 3U);
}

/// A head that serves another client accepts the connection and closes it.
TEST(LineViewer, ALineThatIsClosedWheneverItOpensIsGivenUpAndSaidOnce) {
  RunOptions run = options();
  run.wait = 1200ms;
  Bytes viewer(run, {.bytes = 0, .closes = true});
  viewer.met_without_a_word = true;
  EXPECT_EQ(viewer.run_quietly(), ExitStatus::no_head);
  const std::string why = "closed by the other end";
  const auto first = viewer.said.find(why + "; retrying");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(viewer.said.find(why + "; retrying", first + 1), std::string::npos) << viewer.said;
  EXPECT_THAT(viewer.said, HasSubstr("within 1.2 s: " + why));
}

TEST(LineViewer, PingsThatStayAwayLeaveItIncompleteToo) {
  RunOptions run = options();
  run.ping_wait = 200ms;
  Bytes viewer(run, {});
  EXPECT_EQ(viewer.run_quietly(), ExitStatus::incomplete);
  EXPECT_THAT(viewer.said, HasSubstr("no more pings"));
}

TEST(LineViewer, ATimeThatIsOverEndsItWell) {
  RunOptions run = options();
  run.duration = 200ms;
  Bytes viewer(run, {});
  EXPECT_EQ(viewer.run_quietly(), ExitStatus::ok);
  EXPECT_EQ(viewer.goodbyes, 1);
  EXPECT_EQ(viewer.said, "");
}

TEST(LineViewer, AnAnswerToItsGoodbyeIsWaitedForButNotForEver) {
  for (const bool answers : {true, false}) {
    RunOptions run = options();
    run.pings = 3;
    Bytes viewer(run, {.says_goodbye = answers});
    viewer.patience = answers ? std::chrono::nanoseconds{1h} : std::chrono::nanoseconds{200ms};
    EXPECT_EQ(viewer.run_quietly(), ExitStatus::ok);
    EXPECT_EQ(viewer.goodbyes, 1);
    EXPECT_EQ(viewer.counters->pings, 3U);
  }
}

}  // namespace
}  // namespace sonard::client
