// SPDX-License-Identifier: Apache-2.0
#include "clients/posecast/pose_link.hpp"

#include <array>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <string>
#include <utility>
#include <vector>

#include "protocol/common/endpoint.hpp"

namespace sonard::client {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::ip::udp;
using boost::system::error_code;
using OnFailure = std::function<void(const std::string&)>;

/// Code that both transports share. `Protocol` is asio::ip::udp or asio::ip::tcp.
template <class Protocol>
class ConnectedLink : public PoseLink {
 public:
  ConnectedLink(asio::io_context& io, const Destination& destination, OnFailure on_failure)
      : io_(io),
        socket_(io),
        description_((destination.tcp ? "tcp " : "udp ") + destination.host + ":" + destination.port),
        on_failure_(std::move(on_failure)) {
    error_code error;
    typename Protocol::resolver resolver{io};
    const auto endpoints = resolver.resolve(Protocol::v4(), destination.host, destination.port, error);
    check("resolve", error);
    asio::connect(socket_, endpoints, error);
    check("connect", error);
  }

  const std::string& description() const override { return description_; }
  const LinkCounters& counters() const override { return counters_; }

 protected:
  void fail(const std::string& reason) {
    if (socket_.is_open()) {
      error_code ignored;
      socket_.close(ignored);
      asio::post(io_, [report = on_failure_, what = description_ + ": " + reason] { report(what); });
    }
  }

  asio::io_context& io_;
  typename Protocol::socket socket_;
  LinkCounters counters_;

 private:
  void check(const char* operation, const error_code& error) const {
    if (error) {
      throw LinkError(description_ + ": " + operation + ": " + error.message());
    }
  }

  std::string description_;
  OnFailure on_failure_;
};

class UdpLink final : public ConnectedLink<udp> {
 public:
  using ConnectedLink::ConnectedLink;

  void send(const pose::PoseSample& sample) override {
    const std::vector<std::uint8_t> message = pose::encode(sample);
    error_code error;
    socket_.send(asio::buffer(message), 0, error);
    if (error == asio::error::connection_refused) {
      // The refusal of the previous datagram; this one was not sent yet.
      ++counters_.refused;
      socket_.send(asio::buffer(message), 0, error);
    }
    if (error && error != asio::error::connection_refused) {
      fail("send: " + error.message());
      return;
    }
    ++counters_.sent;
  }

  void when_sent(std::function<void()> done) override { done(); }
  void finish(std::function<void()> done) override { done(); }
};

class TcpLink final : public ConnectedLink<tcp> {
 public:
  TcpLink(asio::io_context& io, const Destination& destination, OnFailure on_failure)
      : ConnectedLink(io, destination, std::move(on_failure)) {
    error_code ignored;
    socket_.set_option(tcp::no_delay{true}, ignored);  // send each pose at once
    watch_for_end();
  }

  void send(const pose::PoseSample& sample) override {
    if (writing_) {
      ++counters_.skipped;
      return;
    }
    writing_ = true;
    frame_ = pose::encode_frame(sample);
    asio::async_write(socket_, asio::buffer(frame_), [this](const error_code& error, std::size_t) {
      writing_ = false;
      if (error) {
        fail("send: " + error.message());
        return;
      }
      ++counters_.sent;
      if (const auto sent = std::exchange(sent_, nullptr)) {
        sent();
      }
    });
  }

  void when_sent(std::function<void()> done) override {
    if (writing_) {
      sent_ = std::move(done);
    } else {
      done();
    }
  }

  // When the receiver has read everything, it closes its end.
  void finish(std::function<void()> done) override {
    when_sent([this, done = std::move(done)]() mutable {
      finished_ = std::move(done);
      error_code ignored;
      socket_.shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

 private:
  /// The receiver sends nothing; a read returns when the receiver closes.
  void watch_for_end() {
    socket_.async_read_some(asio::buffer(received_), [this](const error_code& error, std::size_t) {
      if (error && finished_) {
        finished_();
        return;
      }
      if (error) {
        fail("closed by the receiver");
        return;
      }
      watch_for_end();
    });
  }

  bool writing_ = false;
  std::function<void()> sent_;
  std::function<void()> finished_;
  std::vector<std::uint8_t> frame_;
  std::array<std::uint8_t, 64> received_{};
};

}  // namespace

std::optional<Destination> parse_destination(const std::string& text, bool tcp) {
  const auto parsed = parse_host_and_port(text);
  return parsed ? std::optional(Destination{parsed->host, std::to_string(parsed->port), tcp}) : std::nullopt;
}

std::unique_ptr<PoseLink> connect(asio::io_context& io, const Destination& destination,
                                  OnFailure on_failure) {
  if (destination.tcp) {
    return std::make_unique<TcpLink>(io, destination, std::move(on_failure));
  }
  return std::make_unique<UdpLink>(io, destination, std::move(on_failure));
}

}  // namespace sonard::client
