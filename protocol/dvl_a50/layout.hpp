// SPDX-License-Identifier: Apache-2.0
// Layout table of PD4, the only message of the device that is not text. Source: protocol/dvl_a50/README.md 7.
#pragma once

#include <tuple>

#include "protocol/common/layout.hpp"
#include "protocol/dvl_a50/pathfinder.hpp"

namespace sonard::dvl_a50 {

struct Pd4Layout : WholeLayout<47> {
  static constexpr auto fields = std::tuple{
      Field{0, "id", &Pd4::id},
      Field{1, "structure", &Pd4::structure},
      Field{2, "size", &Pd4::size},
      Field{4, "system", &Pd4::system},
      Field{5, "velocity_mmps", &Pd4::velocity_mmps},
      Field{13, "range_cm", &Pd4::range_cm},
      Field{21, "bottom_status", &Pd4::bottom_status},
      Spare<13>{22},  // of a water layer
      Field{35, "clock", &Pd4::clock},
      Spare<2>{39},
      Field{41, "sound_speed_mps", &Pd4::sound_speed_mps},
      Spare<2>{43},
      Field{45, "checksum", &Pd4::checksum},
  };
};
static_assert(layout_is_contiguous<Pd4Layout>(0));

}  // namespace sonard::dvl_a50
