// SPDX-License-Identifier: Apache-2.0
#include "server/pose/publisher_id.hpp"

#include <tuple>

#include <fmt/format.h>

namespace sonard::server {

std::strong_ordering PublisherId::operator<=>(const PublisherId& other) const {
  return std::tie(endpoint.address, endpoint.port, system_id, component_id) <=>
         std::tie(other.endpoint.address, other.endpoint.port, other.system_id, other.component_id);
}

std::string to_string(const PublisherId& publisher) {
  const std::string endpoint = endpoint_text(publisher.endpoint);
  return publisher.system_id == 0 ? endpoint
                                  : fmt::format("{} system {} component {}", endpoint, publisher.system_id,
                                                publisher.component_id);
}

}  // namespace sonard::server
