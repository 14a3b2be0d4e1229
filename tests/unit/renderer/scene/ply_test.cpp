// SPDX-License-Identifier: Apache-2.0
// PLY by its definition (Turk 1994: http://gamma.cs.unc.edu/POWERPLANT/papers/ply.pdf), written here by hand.
#include "renderer/scene/ply_reader.hpp"

#include <bit>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/mesh_file.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string header(const std::string& format, const std::string& vertex = "3") {
  return "ply\nformat " + format + " 1.0\ncomment by hand\nelement vertex " + vertex +
         "\nproperty float x\nproperty double y\nproperty short z\nproperty uchar red\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
}

template <typename T>
std::string big_endian(T value) {
  std::string bytes;
  const auto number = std::bit_cast<std::array<unsigned char, sizeof value>>(value);
  bytes.assign(number.rbegin(), number.rend());  // on a little-endian machine
  return bytes;
}

template <typename T>
std::string little_endian(T value) {
  const std::string bytes = big_endian(value);
  return {bytes.rbegin(), bytes.rend()};
}

void expect_the_triangle(const RawMesh& mesh) {
  ASSERT_EQ(mesh.parts.size(), 1U);
  EXPECT_THAT(mesh.parts[0].positions,
              ElementsAre(glm::dvec3(0.5, 0.1, -3), glm::dvec3(1, 0, 0), glm::dvec3(0, 2, 258)));
  EXPECT_THAT(mesh.parts[0].indices, ElementsAre(0, 1, 2));
}

class Ply : public testing::Test {
 protected:
  RawMesh read(const std::string& bytes) { return read_ply({folder_.write("hull.ply", bytes)}); }
  std::string error_of(const std::string& bytes) {
    try {
      read(bytes);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }
  test::TempFolder folder_;
};

TEST_F(Ply, IsReadFromTextAndBothByteOrders) {
  expect_the_triangle(read(header("ascii") + "0.5 0.1 -3 255\n1 0 0 0\n0 2 258 7\n3 0 1 2\n"));
  std::string big, little;
  for (const auto& [x, y, z] : {std::tuple{0.5F, 0.1, -3}, {1.0F, 0.0, 0}, {0.0F, 2.0, 258}}) {
    const auto short_z = static_cast<std::int16_t>(z);
    big += big_endian(x) + big_endian(y) + big_endian(short_z) + "r";
    little += little_endian(x) + little_endian(y) + little_endian(short_z) + "r";
  }
  big += "\x03";
  little += "\x03";
  for (const std::int32_t corner : {0, 1, 2}) {
    big += big_endian(corner);
    little += little_endian(corner);
  }
  expect_the_triangle(read(header("binary_big_endian") + big));
  expect_the_triangle(read(header("binary_little_endian") + little));
  for (std::size_t size = 0; size < big.size(); ++size) {
    EXPECT_THAT(error_of(header("binary_big_endian") + big.substr(0, size)),
                HasSubstr("the file is cut short"));
  }
}

TEST_F(Ply, MakesAFanOfEachPolygon) {
  const RawMesh mesh = read(
      "ply\r\nformat ascii 1.0\r\nelement vertex 5\r\nproperty float x\r\nproperty float y\r\nproperty float "
      "z\r\n"
      "property float s\r\nproperty float t\r\nelement edge 1\r\nproperty int vertex1\r\nelement face 1\r\n"
      "property uchar flags\r\nproperty list uchar uint vertex_index\r\nend_header\r\n"
      "0 0 0 0 0\r\n1 0 0 1 0\r\n2 1 0 1 .5\r\n1 2 0 .5 1\r\n0 1 0 0 1\r\n9\r\n7 5 0 1 2 3 4\r\n");
  ASSERT_EQ(mesh.parts.size(), 1U);
  EXPECT_THAT(mesh.parts[0].indices, ElementsAre(0, 1, 2, 0, 2, 3, 0, 3, 4));
  EXPECT_EQ(mesh.parts[0].texcoords.at(3), glm::vec2(0.5F, 1.0F));
}

TEST_F(Ply, TakesEveryTypeOfACount) {
  for (const std::string type : {"char", "uint8", "short", "uint16", "int", "uint32", "float"}) {
    const RawMesh mesh = read(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list " +
        type + " uint32 vertex_indices\nend_header\n0 0 0\n1 0 0\n0 2 3\n3 0 1 2\n");
    ASSERT_EQ(mesh.parts.size(), 1U) << type;
    EXPECT_THAT(mesh.parts[0].indices, ElementsAre(0, 1, 2)) << type;
  }
}

TEST_F(Ply, SaysWhatIsPromisedAndWhatIsThere) {
  EXPECT_EQ(error_of(header("ascii", "1720") + "0 0 0 0\n1 0 0 0\n"),
            "the file is cut short: its header declares 1720 of element vertex, there are 2");
  EXPECT_EQ(error_of(header("ascii", "18446744073709551615") + "0 0 0 0\n"),
            "the file is cut short: its header declares 18446744073709551615 of element vertex, there are 1");
  EXPECT_THAT(error_of("ply\nformat ascii 1.0\nelement ver"), HasSubstr("its header has no end_header"));
}

TEST_F(Ply, NamesTheLineOfABadHeader) {
  EXPECT_EQ(error_of("ply\nformat ascii 1.0\nelement vertex many\nend_header\n"),
            "line 3: an element without a name and a count");
  EXPECT_EQ(error_of("ply\nelement vertex 1\nproperty half x\nend_header\n"),
            "line 3: 'half' is not a type of a property");
  EXPECT_EQ(error_of("ply\nproperty float x\nend_header\n"), "line 2: a property before any element");
  EXPECT_THAT(error_of("plyx ascii\n<html>\n"), HasSubstr("line 1"));
}

// 432 of 1500 files like these once crashed the reader.
TEST_F(Ply, IsAMeshOrASentenceWhateverBytesAreChanged) {
  std::mt19937 random(1);
  std::string binary;
  for (int i = 0; i < 45; ++i) {
    binary += static_cast<char>(i % 5);
  }
  for (const std::string& whole : {header("ascii") + "0.5 0.1 -3 255\n1 0 0 0\n0 2 258 7\n3 0 1 2\n",
                                   header("binary_big_endian") + binary}) {
    for (int i = 0; i < 750; ++i) {
      std::string changed = whole;
      for (unsigned int n = random() % 4; n < 4; ++n) {
        changed[random() % changed.size()] = static_cast<char>(random());
      }
      try {
        read(changed);
      } catch (const std::runtime_error& error) {
        EXPECT_STRNE(error.what(), "");
      }
    }
  }
}

}  // namespace
}  // namespace sonard::render
