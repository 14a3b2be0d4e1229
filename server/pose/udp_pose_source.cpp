#include "server/pose/udp_pose_source.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <bit>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <utility>

#include "server/config/addresses.hpp"

namespace sonard::server {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

struct UdpPoseSource::Impl : std::enable_shared_from_this<UdpPoseSource::Impl> {
  Impl(asio::io_context& io, UdpPoseInput configured, const Clock& used_clock, PoseSink poses_go_to)
      : input(std::move(configured)), clock(used_clock), sink(std::move(poses_go_to)), socket(io) {}

  void open();
  void receive();
  void on_received(const error_code& error, std::size_t length);
  void take(std::span<const std::uint8_t> datagram);
  /// Logs what happened for the `count`th time.
  void complain(std::uint64_t count, const std::string& problem) const;

  UdpPoseInput input;
  const Clock& clock;
  PoseSink sink;
  udp::socket socket;
  Endpoint local;
  udp::endpoint peer;
  std::optional<Endpoint> publisher;  // of the newest pose
  // One byte more than a message may have, so that a longer datagram shows as such.
  std::array<std::uint8_t, pose::max_message_bytes + 1> buffer{};
  PoseSourceCounters counters;
};

void UdpPoseSource::Impl::open() {
  error_code error;
  const auto check = [&](const char* operation) {
    if (error) {
      throw PoseSourceError(
          fmt::format("pose stream udp {}: {}: {}", endpoint_text(input.bind), operation, error.message()));
    }
  };
  socket.open(udp::v4(), error);
  check("open");
  socket.bind({asio::ip::address_v4{input.bind.address}, input.bind.port}, error);
  check("bind");
  const udp::endpoint bound = socket.local_endpoint(error);
  check("local address");
  local = {bound.address().to_v4().to_uint(), bound.port()};
}

void UdpPoseSource::Impl::receive() {
  socket.async_receive_from(asio::buffer(buffer), peer,
                            [self = shared_from_this()](const error_code& error, std::size_t length) {
                              self->on_received(error, length);
                            });
}

void UdpPoseSource::Impl::on_received(const error_code& error, std::size_t length) {
  if (!socket.is_open()) {
    return;
  }
  // An error here is a report about one datagram (for example an ICMP answer); the socket goes on.
  if (!error) {
    take(std::span{buffer}.first(length));
  }
  if (socket.is_open()) {  // the sink may have stopped us
    receive();
  }
}

void UdpPoseSource::Impl::take(std::span<const std::uint8_t> datagram) {
  const TimePoint arrival = clock.now();
  if (!allows(input.allow, peer.address().to_v4().to_uint())) {
    complain(++counters.refused, "not in the allow list");
    return;
  }
  const auto sample = pose::decode(datagram);
  if (!sample) {
    const bool malformed = sample.error().kind == pose::PoseError::Kind::malformed;
    complain(++(malformed ? counters.malformed : counters.bad_value), to_string(sample.error()));
    return;
  }
  ++counters.samples;
  publisher = Endpoint{peer.address().to_v4().to_uint(), peer.port()};
  sink(*sample, arrival);
}

void UdpPoseSource::Impl::complain(std::uint64_t count, const std::string& problem) const {
  if (std::has_single_bit(count)) {
    spdlog::warn("pose stream udp {}: datagram from {} dropped: {} ({} so far)", endpoint_text(local),
                 endpoint_text({peer.address().to_v4().to_uint(), peer.port()}), problem, count);
  }
}

UdpPoseSource::UdpPoseSource(asio::io_context& io, UdpPoseInput input, const Clock& clock, PoseSink sink)
    : impl_(std::make_shared<Impl>(io, std::move(input), clock, std::move(sink))) {}

UdpPoseSource::~UdpPoseSource() {
  stop();
}

void UdpPoseSource::start() {
  impl_->open();
  impl_->receive();
}

void UdpPoseSource::stop() {
  error_code ignored;
  impl_->socket.close(ignored);
}

std::string UdpPoseSource::description() const {
  const bool started = impl_->local.port != 0;
  return "pose stream udp " + endpoint_text(started ? impl_->local : impl_->input.bind);
}

const PoseSourceCounters& UdpPoseSource::counters() const {
  return impl_->counters;
}

std::string UdpPoseSource::heard() const {
  return impl_->publisher ? "from " + endpoint_text(*impl_->publisher) : std::string();
}

Endpoint UdpPoseSource::local_endpoint() const {
  return impl_->local;
}

}  // namespace sonard::server
