// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/gain_law.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::gemini {

namespace {

// The early library sends trunc(500 exp((g - 100) / 25)) for g percent, so percent is logarithmic in
// `spreading`. 0 percent gives 9, 100 percent gives 500. No effect is known of values outside.
constexpr double percent_per_neper = 25.0;
constexpr double spreading_at_0_percent = 9.0;
constexpr double spreading_at_100_percent = 500.0;

}  // namespace

double main_gain_db(std::uint16_t main_gain) {
  const double base_db = 5.5 * (main_gain >> 14);
  const double variable = std::clamp<double>(main_gain & 0x3FFF, 1000.0, 3700.0);
  return base_db + 8.0 + (variable - 1000.0) * (50.0 - 8.0) / (3700.0 - 1000.0);
}

double gain_percent(std::uint16_t spreading) {
  const double known = std::clamp<double>(spreading, spreading_at_0_percent, spreading_at_100_percent);
  return std::max(0.0, 100.0 + percent_per_neper * std::log(known / spreading_at_100_percent));
}

double spreading_gain_db(std::uint16_t spreading, const GainLaw& law) {
  // Both client libraries have a linear slider in percent, and users expect equal steps to have equal effect.
  // So dB is linear in percent. Only `spreading` is sent, and the two libraries encode 50 percent
  // differently. The head cannot distinguish the libraries and treats equal values alike.
  const double audible = std::clamp<double>(spreading, spreading_at_0_percent, spreading_at_100_percent);
  const double percent_above_reference = percent_per_neper * std::log(audible / law.reference_spreading);
  return law.db_per_percent * percent_above_reference;
}

double receive_gain_db(std::uint16_t main_gain, std::uint16_t spreading, const GainLaw& law) {
  return main_gain_db(main_gain) - law.nominal_main_gain_db + spreading_gain_db(spreading, law);
}

}  // namespace sonard::gemini
