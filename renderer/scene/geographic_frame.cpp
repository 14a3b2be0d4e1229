// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/geographic_frame.hpp"

#include "renderer/scene/world.hpp"

#ifdef SONARD_HAS_GEOGRAPHICLIB

#include <exception>
#include <vector>

#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <glm/mat3x3.hpp>

namespace sonard::render {

struct GeographicFrame::Impl {
  GeographicLib::LocalCartesian local;
};

GeographicFrame::GeographicFrame(const GeographicOrigin& origin)
    : impl_(std::make_shared<const Impl>(
          Impl{{origin.latitude_deg, origin.longitude_deg, origin.altitude_m}})) {}

Pose GeographicFrame::T_world_place(double latitude_deg, double longitude_deg, double altitude_m) const {
  Pose T_world_place;
  glm::dvec3& p = T_world_place.position_m;
  std::vector<double> rows(9);
  impl_->local.Forward(latitude_deg, longitude_deg, altitude_m, p.x, p.y, p.z, rows);
  const glm::dmat3 columns(rows[0], rows[3], rows[6], rows[1], rows[4], rows[7], rows[2], rows[5], rows[8]);
  T_world_place.orientation = glm::normalize(glm::quat_cast(columns));
  return T_world_place;
}

GeographicOrigin place_of_utm(int zone, bool northern, double easting_m, double northing_m) {
  GeographicOrigin place;
  try {
    GeographicLib::UTMUPS::Reverse(zone, northern, easting_m, northing_m, place.latitude_deg,
                                   place.longitude_deg);
  } catch (const std::exception& error) {
    throw WorldError(error.what());
  }
  return place;
}

}  // namespace sonard::render

#else

namespace sonard::render {

namespace {

[[noreturn]] void refuse() {
  throw WorldError("places on Earth need GeographicLib, and this sonard was built without it");
}

}  // namespace

struct GeographicFrame::Impl {};
GeographicFrame::GeographicFrame(const GeographicOrigin&) {
  refuse();
}
Pose GeographicFrame::T_world_place(double, double, double) const {
  refuse();
}
GeographicOrigin place_of_utm(int, bool, double, double) {
  refuse();
}

}  // namespace sonard::render

#endif
