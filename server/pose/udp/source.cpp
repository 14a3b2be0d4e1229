// SPDX-License-Identifier: Apache-2.0
#include "server/pose/udp/source.hpp"

#include <spdlog/spdlog.h>

#include <bit>
#include <optional>
#include <utility>

#include "server/net/addresses.hpp"
#include "server/pose/udp_listener.hpp"
#include "server/pose/unreadable_messages.hpp"
#include "server/program_log/reasons.hpp"

namespace sonard::server {

struct UdpPoseSource::Impl : std::enable_shared_from_this<UdpPoseSource::Impl> {
  Impl(boost::asio::io_context& io, const UdpPoseInput& input, const Clock& clock, PoseSink poses_go_to)
      : listener(io, "pose stream udp", input.bind, input.allow, clock), sink(std::move(poses_go_to)) {}

  void take(std::span<const std::uint8_t> datagram, TimePoint arrival);
  void complain(const std::string& problem);

  UdpListener listener;
  PoseSink sink;
  std::optional<PublisherId> publisher;  // of the newest pose
  PoseSourceCounters counters;
  Reasons complaints;
  UnreadableMessages unreadable;
};

void UdpPoseSource::Impl::take(std::span<const std::uint8_t> datagram, TimePoint arrival) {
  const auto sample = pose::decode(datagram);
  if (!sample) {
    const bool malformed = sample.error().kind == pose::PoseError::Kind::malformed;
    ++(malformed ? counters.malformed : counters.bad_value);
    const std::string problem = to_string(sample.error()) + mavlink_hint(datagram);
    unreadable.note(arrival, endpoint_text(listener.peer()), problem);
    complain(problem);
    return;
  }
  ++counters.samples;
  publisher = {listener.peer()};
  sink(*sample, arrival);
}

void UdpPoseSource::Impl::complain(const std::string& problem) {
  if (const std::uint64_t count = complaints.count(problem); std::has_single_bit(count)) {
    spdlog::warn("{}: datagram from {} dropped: {} ({} so far)", listener.description(),
                 endpoint_text(listener.peer()), problem, count);
  }
}

UdpPoseSource::UdpPoseSource(boost::asio::io_context& io, const UdpPoseInput& input, const Clock& clock,
                             PoseSink sink)
    : impl_(std::make_shared<Impl>(io, input, clock, std::move(sink))) {}

UdpPoseSource::~UdpPoseSource() {
  UdpPoseSource::stop();
}

void UdpPoseSource::start() {
  impl_->listener.start(
      [weak = impl_->weak_from_this()](std::span<const std::uint8_t> datagram, TimePoint arrival) {
        if (const auto impl = weak.lock()) {
          impl->take(datagram, arrival);
        }
      });
}

void UdpPoseSource::stop() {
  impl_->listener.close();
}

std::string UdpPoseSource::description() const {
  return impl_->listener.description();
}

const PoseSourceCounters& UdpPoseSource::counters() const {
  impl_->counters.refused = impl_->listener.refused();
  return impl_->counters;
}

std::optional<PublisherId> UdpPoseSource::publisher() const {
  return impl_->publisher;
}

std::string UdpPoseSource::unreadable(TimePoint now) const {
  return impl_->unreadable.text(now);
}

Endpoint UdpPoseSource::local_endpoint() const {
  return impl_->listener.local();
}

}  // namespace sonard::server
