// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/heightfield.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/image_file.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::filesystem::path data = std::filesystem::path(SONARD_SOURCE_DIR) / "tests/data/worlds";

TEST(GreyImage, ReadsEightBitsBottomRowFirst) {
  const GreyImage image = load_grey_image(data / "grey8.png");
  EXPECT_EQ(image.width_px, 3);
  EXPECT_EQ(image.height_px, 2);
  EXPECT_THAT(image.value, ElementsAre(10 * 257, 20 * 257, 30 * 257, 0, 51 * 257, 65535));
}

TEST(GreyImage, ReadsSixteenBits) {
  EXPECT_THAT(load_grey_image(data / "grey16.png").value, ElementsAre(1, 2, 20000, 0, 256, 40000));
}

// Lowest -31.5 and -31 m, highest -26.5 and -26: 65535 / 5 = 13107 a metre.
TEST(ElevationMap, ReadsElevationsOfTiffs) {
  EXPECT_THAT(load_elevation_map(data / "elevation_f32.tif").picture.value,
              ElementsAre(45875, 55705, 65535, 0, 19661, 32768));  // 3.5, 4.25, 5; 0, 1.5, 2.5 m
  EXPECT_THAT(load_elevation_map(data / "elevation_i16.tif").picture.value,
              ElementsAre(39321, 52428, 65535, 0, 13107, 26214));
}

// GDAL recognises these by their content; they name files and servers.
TEST(ElevationMap, IsATiffAndNoRecipeOfGdal) {
  const test::TempFolder folder;
  const std::string source = (data / "elevation_f32.tif").string();
  const auto error_of = [&](const std::string& text) -> std::string {
    try {
      load_elevation_map(folder.write("bed.tif", text));
    } catch (const WorldError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(error_of("<VRTDataset rasterXSize=\"3\" rasterYSize=\"2\"><VRTRasterBand dataType=\"Float32\" "
                       "band=\"1\"><SimpleSource><SourceFilename>" +
                       source +
                       "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand>"
                       "</VRTDataset>"),
              HasSubstr("bed.tif: it is not a TIFF"));
  EXPECT_THAT(error_of("<GDAL_WMS><Service name=\"TMS\"><ServerUrl>http://127.0.0.1:9/${z}/${x}/${y}.png"
                       "</ServerUrl></Service></GDAL_WMS>"),
              HasSubstr("bed.tif: it is not a TIFF"));
}

TEST(NormalMapImage, HasRowZeroAtTheBottom) {
  const NormalMap map = load_normal_map(data / "normal_map.png");
  EXPECT_EQ(map.width_px, 2);
  EXPECT_EQ(map.height_px, 2);
  EXPECT_THAT(map.rgb, ElementsAre(128, 128, 255, 1, 2, 3, 255, 0, 128, 0, 255, 128));
}

std::string normal_map_error(const std::filesystem::path& file) {
  try {
    load_normal_map(file);
  } catch (const WorldError& error) {
    return error.what();
  }
  return "";
}

TEST(Image, ErrorsNameTheFile) {
  const test::TempFolder folder;
  EXPECT_THAT(normal_map_error("/nowhere/x.png"), HasSubstr("/nowhere/x.png: image file not found"));
  EXPECT_THAT(normal_map_error(folder.write("a.exr", "x")), HasSubstr("supported: png"));
  EXPECT_THAT(normal_map_error(folder.write("bad.png", "not a picture")), HasSubstr("bad.png: "));
  EXPECT_THAT(normal_map_error(data / "grey8.png"), HasSubstr("needs 3 channels, this image has 1"));
  EXPECT_THAT(normal_map_error("http://127.0.0.1/x.png"), HasSubstr("sonard downloads nothing"));
}

TEST(Image, DamagedFilesAreErrors) {
  const test::TempFolder folder;
  for (const int size : {0, 1, 8, 20, 33, 40, 50, 60}) {
    std::string bytes(static_cast<std::size_t>(size), '\0');
    std::ifstream(data / "normal_map.png", std::ios::binary).read(bytes.data(), size);
    const auto file = folder.write("cut.png", bytes);
    EXPECT_NE(normal_map_error(file), "") << size << " bytes";
  }
}

// 3 x 2 pixels over 4 m x 2 m: steps of 2 m; black 0, white (the brightest) 3 m above z = -10.
TEST(Heightfield, PutsPixelsWhereGazeboPutsThem) {
  GreyImage image{3, 2, {0, 0, 0, 0, 500, 1000}};
  const TriangleMesh mesh = make_heightfield(image, {4.0, 2.0, 3.0}, {10.0, 20.0, -10.0});
  EXPECT_EQ(mesh.triangle_count(), 4U);
  ASSERT_EQ(mesh.positions.size(), 6U);
  EXPECT_EQ(mesh.positions[0], glm::vec3(8, 19, -10));     // bottom left: -x, -y
  EXPECT_EQ(mesh.positions[2], glm::vec3(12, 19, -10));    // bottom right
  EXPECT_EQ(mesh.positions[4], glm::vec3(10, 21, -8.5F));  // top middle, half as bright
  EXPECT_EQ(mesh.positions[5], glm::vec3(12, 21, -7));
  EXPECT_EQ(mesh.texcoords[2], glm::vec2(1, 0));
  EXPECT_EQ(mesh.texcoords[5], glm::vec2(1, 1));
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    EXPECT_GT(test::area_normal(mesh, t).z, 0.0);
  }
}

TEST(Heightfield, OfASlopeHasTheNormalOfTheSlope) {
  // z = x / 2 over 8 m x 8 m.
  GreyImage image{5, 5, {}};
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) {
      image.value.push_back(static_cast<std::uint16_t>(100 * x));
    }
  }
  const TriangleMesh mesh = make_heightfield(image, {8.0, 8.0, 4.0}, {0.0, 0.0, 0.0});
  for (const glm::vec3& normal : mesh.normals) {
    EXPECT_NEAR(glm::distance(normal, glm::normalize(glm::vec3(-1, 0, 2))), 0.0, 1e-6);
  }
  EXPECT_NEAR(test::area_m2(mesh), 8.0 * 8.0 * std::sqrt(1.25), 1e-4);
}

TEST(Heightfield, MayBeFlat) {
  const TriangleMesh mesh = make_heightfield({2, 2, {0, 0, 0, 0}}, {1.0, 1.0, 5.0}, {0.0, 0.0, -3.0});
  EXPECT_EQ(test::bounds(mesh).high.z, -3.0);
}

TEST(Heightfield, OfANegativeHeightHasItsBrightestPixelBelow) {
  const TriangleMesh mesh = make_heightfield({2, 2, {0, 0, 0, 100}}, {20.0, 10.0, -4.0}, {0.0, 0.0, 1.0});
  EXPECT_EQ(test::bounds(mesh).high.z, 1.0);
  EXPECT_EQ(test::bounds(mesh).low.z, -3.0);
}

TEST(Heightfield, RefusesImpossibleSizes) {
  const GreyImage image{2, 2, {0, 0, 0, 1}};
  EXPECT_THROW(make_heightfield(image, {0.0, 1.0, 1.0}, {}), WorldError);
  EXPECT_THROW(make_heightfield(image, {1.0, -1.0, 1.0}, {}), WorldError);
  EXPECT_THROW(make_heightfield(image, {1.0, std::numeric_limits<double>::infinity(), 1.0}, {}), WorldError);
  EXPECT_THROW(make_heightfield({1, 4, {0, 0, 0, 0}}, {1.0, 1.0, 1.0}, {}), WorldError);
}

}  // namespace
}  // namespace sonard::render
