// SPDX-License-Identifier: Apache-2.0
#include "protocol/oculus/fire_warnings.hpp"

#include <string_view>

#include <fmt/format.h>

#include "protocol/oculus/ping_plan.hpp"

namespace sonard::oculus {
namespace {

constexpr std::uint8_t standby = 5;  // the last code of a rate

/// A number of a fire, and the limits to which the head clamps it.
struct Limited {
  std::string_view field;
  double value = 0.0;
  double least = 0.0;
  double most = 0.0;

  bool holds() const { return value >= least && value <= most; }  // false for NaN
};

Limited range_limits(const Fire& fire, const Mode& mode) {
  const bool metres = (fire.flags & fire_flags::range_in_metres) != 0;
  return metres ? Limited{"range in metres", fire.range, least_range_m, mode.most_range_m}
                : Limited{"range in percent", fire.range, 100.0 * least_range_m / mode.most_range_m, 100.0};
}

}  // namespace

bool requests_full_result(const Fire& fire) {
  return (fire.flags & fire_flags::simple_result) == 0;
}

bool FireWarnings::check(const Fire& fire, std::vector<Notice>& notices) {
  bool changed = false;
  const auto change = [&](std::string_view field, std::string text) {
    warnings_.warn(field, std::move(text), notices);
    changed = true;
  };
  if (fire.master_mode != 1 && !model_.has_high_frequency()) {
    change("masterMode",
           fmt::format("the client's masterMode {} is not 1: this head has one frequency", fire.master_mode));
  } else if (fire.master_mode != 1 && fire.master_mode != 2) {
    change("masterMode",
           fmt::format("the client's masterMode {} is unknown: the head uses 2, the high frequency",
                       fire.master_mode));
  }
  if (fire.ping_rate > standby) {
    change("pingRate",
           fmt::format("the client's pingRate {} is unknown: the head uses 0, 10 pings per second",
                       fire.ping_rate));
  }
  const Limited sound_speed{"speedOfSound", fire.sound_speed_mps, least_sound_speed_mps,
                            most_sound_speed_mps};
  for (const Limited& limited : {range_limits(fire, model_.mode(fire.master_mode)),
                                 Limited{"gainPercent", fire.gain_percent, 0.0, 100.0}, sound_speed}) {
    const bool computed = limited.field == sound_speed.field && limited.value == 0.0;
    if (!limited.holds() && !computed) {
      change(limited.field, fmt::format("the client's {} {} is out of range: the head uses {:.4g} to {:.4g}",
                                        limited.field, limited.value, limited.least, limited.most));
    }
  }
  if (requests_full_result(fire)) {
    warnings_.warn("full result", "the client requests the full result (0x22): sonard sends 0x23", notices);
  }
  return changed;
}

}  // namespace sonard::oculus
