// SPDX-License-Identifier: Apache-2.0
#include "server/pose/publisher_id.hpp"

#include <fmt/format.h>

namespace sonard::server {

std::string to_string(const PublisherId& publisher) {
  const std::string endpoint = endpoint_text(publisher.endpoint);
  return publisher.system_id == 0 ? endpoint
                                  : fmt::format("{} system {} component {}", endpoint, publisher.system_id,
                                                publisher.component_id);
}

}  // namespace sonard::server
