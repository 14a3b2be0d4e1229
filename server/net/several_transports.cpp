// SPDX-License-Identifier: Apache-2.0
#include "server/net/several_transports.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace sonard::server {

void SeveralTransports::start(TransportEvents events) {
  for (std::size_t i = 0; i < transports_.size(); ++i) {
    const int channel = static_cast<int>(i);
    TransportEvents of_one = events;
    of_one.received = [to = events.received, channel](BytesReceived bytes) {
      bytes.from.channel = channel;
      to(std::move(bytes));
    };
    of_one.came = [to = events.came, channel](ClientCame came) {
      came.who.channel = channel;
      to(came);
    };
    of_one.gone = [to = events.gone, channel](ClientGone gone) {
      gone.who.channel = channel;
      to(gone);
    };
    transports_[i]->start(std::move(of_one));
  }
}

void SeveralTransports::stop() {
  for (const std::unique_ptr<Transport>& transport : transports_) {
    transport->stop();
  }
}

void SeveralTransports::send(std::vector<Outgoing> messages) {
  for (std::size_t i = 0; i < transports_.size(); ++i) {
    std::vector<Outgoing> here;
    for (const Outgoing& message : messages) {
      if (message.to == Outgoing::To::everybody || message.peer.channel == static_cast<int>(i)) {
        here.push_back(message);
      }
    }
    if (!here.empty()) {
      transports_[i]->send(std::move(here));
    }
  }
}

void SeveralTransports::disconnect(const Peer& client) {
  transports_.at(static_cast<std::size_t>(client.channel))->disconnect(client);
}

bool SeveralTransports::blocked() const {
  return std::ranges::any_of(transports_, [](const auto& transport) { return transport->blocked(); });
}

std::vector<std::string> SeveralTransports::descriptions() const {
  std::vector<std::string> all;
  for (const std::unique_ptr<Transport>& transport : transports_) {
    std::ranges::move(transport->descriptions(), std::back_inserter(all));
  }
  return all;
}

std::string SeveralTransports::faults() const {
  for (const std::unique_ptr<Transport>& transport : transports_) {
    if (std::string faults = transport->faults(); !faults.empty()) {
      return faults;  // the same section of the configuration sets all
    }
  }
  return "";
}

std::vector<Counter> SeveralTransports::counts() const {
  std::vector<Counter> sums;
  for (const std::unique_ptr<Transport>& transport : transports_) {
    for (Counter& counter : transport->counts()) {
      const auto known = std::ranges::find_if(sums, [&](const Counter& sum) {
        return sum.name == counter.name && sum.warning == counter.warning;
      });
      if (known != sums.end()) {
        known->value += counter.value;
      } else {
        sums.push_back(std::move(counter));
      }
    }
  }
  return sums;
}

}  // namespace sonard::server
