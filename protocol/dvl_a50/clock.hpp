// SPDX-License-Identifier: Apache-2.0
// The clock of the device, and the commands that set it (2).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/common/ping_job.hpp"

namespace sonard::dvl_a50 {

class Clock {
 public:
  /// @param unix_offset from the clock of Device::step() to the time since 1970
  /// @param synced a time server sets the clock
  /// @param start when the server did so first
  Clock(std::chrono::nanoseconds unix_offset, bool synced, TimePoint start)
      : offset_(unix_offset), synced_(synced), start_(start) {}

  /// Microseconds since 1970.
  std::int64_t unix_us(TimePoint time) const;
  bool synced() const { return synced_; }
  const std::string& server() const { return server_; }

  /// @return false if this can be no address
  bool set_server(std::string_view address);
  /// @return false if the time is before 1970 or after 2096
  bool set(TimePoint now, std::optional<std::int64_t> unix_us);

  std::string status_json(TimePoint now) const;
  std::string status_sentence(TimePoint now) const;  ///< wrs, without its checksum

 private:
  std::int64_t seconds_since_sync(TimePoint now) const {
    return (now - start_) / std::chrono::seconds{1} % 64;
  }

  std::chrono::nanoseconds offset_;
  const bool synced_;
  const TimePoint start_;
  std::string server_ = "auto";
};

}  // namespace sonard::dvl_a50
