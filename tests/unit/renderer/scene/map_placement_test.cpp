// SPDX-License-Identifier: Apache-2.0
// Georeferenced maps in worlds. The tests write files tag by tag after TIFF 6.0 and OGC GeoTIFF 1.1. Places
// are computed by hand: on the equator at the middle of a zone of UTM, where a metre of the grid is 1 /
// 0.9996 m.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "renderer/scene/image_file.hpp"
#include "renderer/scene/world.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A TIFF of `side_px` by `side_px` pixels of float.
struct TiffSpec {
  int side_px = 11;
  std::vector<float> elevation_m;  ///< from the upper left, row by row
  std::vector<double> scale{10, 10, 0};
  std::vector<double> tie{0, 0, 0, 500045, 105, 0};  ///< place of raster 0, 0
  std::vector<std::uint16_t> keys;                   ///< id, value, id, value, ...
  std::string no_data;  ///< of more than 3 characters: shorter values would lie in the directory
};

class TiffWriter {
 public:
  explicit TiffWriter(const TiffSpec& spec) {
    const auto side = static_cast<std::uint32_t>(spec.side_px);
    std::vector<std::uint16_t> directory{1, 1, 1, static_cast<std::uint16_t>(spec.keys.size() / 2)};
    for (std::size_t i = 0; i < spec.keys.size(); i += 2) {
      directory.insert(directory.end(), {spec.keys[i], 0, 1, spec.keys[i + 1]});
    }
    number(256, side);  // width
    number(257, side);  // height
    number(258, 32);    // bits
    number(259, 1);     // no compression
    number(262, 1);     // black is zero
    number(273, 8);     // the strip follows the header
    number(277, 1);     // samples
    number(278, side);  // rows in the strip
    number(279, 4 * side * side);
    number(339, 3);  // float
    values(33550, 12, spec.scale);
    values(33922, 12, spec.tie);
    values(34735, 3, directory);
    if (!spec.no_data.empty()) {
      values(42113, 2,
             std::vector<char>(spec.no_data.c_str(), spec.no_data.c_str() + spec.no_data.size() + 1));
    }
    bytes_ = "II*\0";
    bytes_.resize(4);
    const std::size_t data = 8 + spec.elevation_m.size() * 4;
    put(static_cast<std::uint32_t>(data + more_.size()));
    bytes_.append(reinterpret_cast<const char*>(spec.elevation_m.data()), spec.elevation_m.size() * 4);
    bytes_ += more_;
    put(static_cast<std::uint16_t>(entries_.size()));
    for (const Entry& entry : entries_) {
      put(entry.tag);
      put(entry.type);
      put(entry.count);
      put(entry.is_offset ? entry.value + static_cast<std::uint32_t>(data) : entry.value);
    }
    put(std::uint32_t{0});
  }

  const std::string& bytes() const { return bytes_; }

 private:
  struct Entry {
    std::uint16_t tag, type;
    std::uint32_t count, value;
    bool is_offset = false;
  };

  void number(std::uint16_t tag, std::uint32_t value) { entries_.push_back({tag, 4, 1, value}); }

  template <typename T>
  void values(std::uint16_t tag, std::uint16_t type, const std::vector<T>& all) {
    entries_.push_back(
        {tag, type, static_cast<std::uint32_t>(all.size()), static_cast<std::uint32_t>(more_.size()), true});
    more_.append(reinterpret_cast<const char*>(all.data()), all.size() * sizeof(T));
    more_.resize((more_.size() + 7) / 8 * 8);
  }

  template <typename T>
  void put(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }

  std::string bytes_, more_;
  std::vector<Entry> entries_;
};

/// A slope that rises to the east from -30 to -20 m.
TiffSpec slope() {
  TiffSpec spec;
  for (int y = 0; y < spec.side_px; ++y) {
    for (int x = 0; x < spec.side_px; ++x) {
      spec.elevation_m.push_back(static_cast<float>(-30 + x));
    }
  }
  spec.keys = {1024, 1,     1025, 1,
               3072, 32632, 4096, 5773};  // projected, pixels are areas, UTM 32 north, EGM96
  return spec;
}

class MapPlacementTest : public testing::Test {
 protected:
  World load(const TiffSpec& spec, const std::optional<GeographicOrigin>& origin,
             const std::string& heightmap = "", const std::string& in_world = "") {
    folder_.write("bed.tif", TiffWriter(spec).bytes());
    return load_world(
        folder_.write("bed.sdf", "<sdf version='1.9'><world name='w'>" + in_world +
                                     "<model name='bed'><link name='l'><visual name='v'><geometry><heightmap>"
                                     "<uri>bed.tif</uri>" +
                                     heightmap +
                                     "</heightmap></geometry></visual></link></model></world></sdf>"),
        {}, MissingFiles::error, origin);
  }

  std::string error_of(const TiffSpec& spec) {
    try {
      load(spec, GeographicOrigin{});
    } catch (const WorldError& error) {
      return error.what();
    }
    return "";
  }

  test::TempFolder folder_;
};

constexpr GeographicOrigin middle_of_zone{0.0, 9.0, 0.0};

TEST_F(MapPlacementTest, AMapInUtmLiesEastAndNorthOfTheOrigin) {
  const World world = load(slope(), middle_of_zone);
  const BodyPart& part = world.bodies.at(0).parts.at(0);
  // The middle of the middle pixel, (5, 5), is 5.5 pixels from the tie point.
  EXPECT_NEAR(part.T_body_part.position_m.x, 100 / 0.9996, 1e-2);
  EXPECT_NEAR(part.T_body_part.position_m.y, 50 / 0.9996, 1e-2);
  EXPECT_NEAR(part.T_body_part.position_m.z, -30, 1e-2);
  const auto [low, high] = std::ranges::minmax(part.mesh->positions, {}, &glm::vec3::x);
  EXPECT_NEAR(high.x - low.x, 100 / 0.9996, 1e-2);
  EXPECT_NEAR(high.z - low.z, 10, 1e-3);
  EXPECT_THAT(world.maps, ElementsAre(HasSubstr(
                              "bed.tif: EPSG:32632, middle at 0.000452, 9.000899, 100.04 x 100.04 m, "
                              "elevations -30.00 to -20.00 m above EPSG:5773 (EGM96 height); corners")));
}

TEST_F(MapPlacementTest, PixelsThatArePointsBeginAtTheTiePoint) {
  TiffSpec spec = slope();
  spec.keys[3] = 2;
  const World world = load(spec, middle_of_zone);
  EXPECT_NEAR(world.bodies.at(0).parts.at(0).T_body_part.position_m.x, 95 / 0.9996, 1e-2);
  EXPECT_NEAR(world.bodies.at(0).parts.at(0).T_body_part.position_m.y, 55 / 0.9996, 1e-2);
}

TEST_F(MapPlacementTest, AMapInDegreesIsAsLargeAsTheEllipsoidSays) {
  TiffSpec spec = slope();
  spec.keys = {1024, 2, 1025, 1, 2048, 4326};
  spec.scale = {1e-4, 1e-4, 0};
  spec.tie = {5.5, 5.5, 0, 9.0, 0.0, 0};
  const World world = load(spec, middle_of_zone);
  const BodyPart& part = world.bodies.at(0).parts.at(0);
  EXPECT_NEAR(part.T_body_part.position_m.x, 0, 1e-6);
  const auto [west, east] = std::ranges::minmax(part.mesh->positions, {}, &glm::vec3::x);
  const auto [south, north] = std::ranges::minmax(part.mesh->positions, {}, &glm::vec3::y);
  EXPECT_NEAR(east.x - west.x, 1e-3 * 111319.49, 1e-2);    // a pi / 180
  EXPECT_NEAR(north.y - south.y, 1e-3 * 110574.28, 1e-2);  // a (1 - e^2) pi / 180
  EXPECT_THAT(world.maps, ElementsAre(HasSubstr("above an unknown datum")));
}

TEST_F(MapPlacementTest, TheOriginOfTheWorldFileServesAndAltitudeIsSubtracted) {
  const World world =
      load(slope(), std::nullopt, "",
           "<spherical_coordinates><surface_model>EARTH_WGS84</surface_model>"
           "<latitude_deg>0</latitude_deg><longitude_deg>9</longitude_deg><elevation>-20</elevation>"
           "</spherical_coordinates>");
  EXPECT_EQ(world.origin, (GeographicOrigin{0.0, 9.0, -20.0}));
  EXPECT_NEAR(world.bodies.at(0).parts.at(0).T_body_part.position_m.z, -10, 1e-2);
  EXPECT_THAT(world.warnings, testing::IsEmpty());
}

TEST_F(MapPlacementTest, ATurnedFrameIsNotGuessedAt) {
  const World world = load(slope(), std::nullopt, "",
                           "<spherical_coordinates><heading_deg>30</heading_deg></spherical_coordinates>");
  EXPECT_EQ(world.origin, std::nullopt);
  EXPECT_THAT(world.warnings, ElementsAre(HasSubstr("is not used: heading_deg 30 (expected 0)")));
}

TEST_F(MapPlacementTest, WithoutAPlaceOnEarthTheMapIsInTheMiddle) {
  const World world = load(slope(), std::nullopt);
  EXPECT_NEAR(glm::length(world.bodies.at(0).parts.at(0).T_body_part.position_m - glm::dvec3(0, 0, -30)), 0,
              1e-6);
}

TEST_F(MapPlacementTest, AGivenSizePlacesItByHand) {
  const World world = load(slope(), middle_of_zone, "<size>40 40 10</size><pos>1 2 3</pos>");
  EXPECT_EQ(world.bodies.at(0).parts.at(0).T_body_part.position_m, glm::dvec3(1, 2, 3));
  EXPECT_THAT(world.maps, testing::IsEmpty());
}

TEST_F(MapPlacementTest, PixelsWithoutAnElevationAreHoles) {
  TiffSpec spec = slope();
  spec.no_data = "-9999";
  spec.elevation_m[5 * 11 + 5] = -9999;
  const World world = load(spec, middle_of_zone);
  const TriangleMesh& mesh = *world.bodies.at(0).parts.at(0).mesh;
  EXPECT_EQ(mesh.indices.size() / 3, 200U - 6U);  // six triangles meet in a pixel
  const auto [low, high] = std::ranges::minmax(mesh.positions, {}, &glm::vec3::z);
  EXPECT_NEAR(high.z - low.z, 10, 1e-3);
  for (const std::uint32_t index : mesh.indices) {  // an even slope, also beside the hole
    EXPECT_NEAR(mesh.normals[index].x, -0.1 / std::sqrt(1.01), 1e-3);
  }
  EXPECT_THAT(world.maps, ElementsAre(HasSubstr("1 pixels without an elevation (holes)")));
}

TEST_F(MapPlacementTest, HolesStayInLargeMaps) {
  TiffSpec spec = slope();
  spec.side_px = 400;
  spec.elevation_m.assign(400 * 400, -25.0F);
  spec.elevation_m[100 * 400 + 300] = -20.0F;
  spec.no_data = "-9999";
  for (int i = 0; i < 400; ++i) {
    spec.elevation_m[static_cast<std::size_t>(200 * 400 + i)] = -9999;
  }
  const World world = load(spec, middle_of_zone);
  ASSERT_EQ(world.terrains.size(), 1U);
  EXPECT_THAT(world.maps, ElementsAre(HasSubstr("400 pixels without an elevation (holes)")));
}

TEST_F(MapPlacementTest, ErrorsSayWhatIsMissing) {
  TiffSpec spec = slope();
  spec.keys = {};
  EXPECT_THAT(error_of(spec), HasSubstr("bed.tif: it has no coordinate system; give the <size>"));
  spec.keys = {1024, 1, 3072, 2154};
  EXPECT_THAT(error_of(spec), HasSubstr("EPSG:2154 is not known (expected EPSG:4326 or UTM"));
  spec.keys = {3072, 32632, 4096, 5715};
  EXPECT_THAT(error_of(spec),
              HasSubstr("its values are depths, EPSG:5715 (mean sea level depth): negate them"));
  spec.keys = {3072, 32632, 4099, 9002};
  EXPECT_THAT(error_of(spec), HasSubstr("in units of EPSG:9002 (expected 9001, metres)"));
  spec = slope();
  spec.scale = {10, 0, 0};
  EXPECT_THAT(error_of(spec), HasSubstr("no pixel scale and tie point"));
  spec = slope();
  spec.tie[4] = 1e9;
  EXPECT_THAT(error_of(spec), HasSubstr("bed.sdf"));
  spec = slope();
  spec.no_data = "-30.0";
  spec.elevation_m.assign(spec.elevation_m.size(), -30.0F);
  EXPECT_THAT(error_of(spec), HasSubstr("no pixel has an elevation"));
}

}  // namespace
}  // namespace sonard::render
