// SPDX-License-Identifier: Apache-2.0
// STL files, text and binary, with variants of public files. Boxes and counts are computed by hand.
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/mesh_file.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// One triangle: (x 0 0) (x+1 0 0) (x 2 0).
std::string solid(const std::string& name, int x) {
  const std::string at = std::to_string(x);
  return "solid " + name + "\n  facet normal 0 0 1\n    outer loop\n      vertex " + at +
         " 0 0\n      vertex " + std::to_string(x + 1) + ".0e+0 +0 -0.0\n      vertex " + at +
         " 2 0\n    endloop\n  endfacet\nendsolid " + name + "\n";
}

std::string in_capitals(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

/// `count` triangles as in solid(), next to each other along x.
std::string binary(const std::string& header, int count) {
  std::string bytes = header;
  bytes.resize(80, '\0');
  const auto put = [&bytes](const auto& value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  };
  put(static_cast<std::uint32_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto x = static_cast<float>(i);
    for (const float value : {0.0F, 0.0F, 0.0F, x, 0.0F, 0.0F, x + 1, 0.0F, 0.0F, x, 2.0F, 0.0F}) {
      put(value);
    }
    put(std::uint16_t{0x8421});  // a colour, in files of some programs
  }
  return bytes;
}

class Stl : public testing::Test {
 protected:
  MeshFile load(const std::string& bytes, const std::string& submesh = "") const {
    MeshFileRequest request;
    request.file = folder_.write("hull.stl", bytes);
    request.submesh = submesh;
    return load_mesh_file(request);
  }

  std::string error_of(const std::string& bytes, const std::string& submesh = "") const {
    try {
      load(bytes, submesh);
    } catch (const WorldError& error) {
      return error.what();
    }
    return "";
  }

  void expect_triangles(const std::string& bytes, std::size_t count, double x_low, double x_high,
                        const std::string& submesh = "") const {
    SCOPED_TRACE(bytes.substr(0, 40));
    const MeshFile file = load(bytes, submesh);
    ASSERT_EQ(file.parts.size(), 1U);
    const TriangleMesh& mesh = *file.parts[0].mesh;
    EXPECT_EQ(mesh.triangle_count(), count);
    EXPECT_EQ(test::bounds(mesh).low, glm::dvec3(x_low, 0, 0));
    EXPECT_EQ(test::bounds(mesh).high, glm::dvec3(x_high, 2, 0));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(file.warnings.empty());
  }

  test::TempFolder folder_;
};

TEST_F(Stl, ReadsATextWhateverItBeginsWith) {
  const std::string text = solid("a", 5);
  for (const std::string before : {"", "  ", "\t", "\n\r\n  ", "\xEF\xBB\xBF"}) {
    expect_triangles(before + text, 1, 5, 6);
  }
  expect_triangles(in_capitals(text), 1, 5, 6);
  expect_triangles(" " + replaced(replaced(text, "solid", "Solid"), "vertex", "Vertex"), 1, 5, 6);
  expect_triangles(replaced(text, "\n", "\r\n"), 1, 5, 6);
  expect_triangles(replaced(text, "\n", "\r"), 1, 5, 6);
  expect_triangles(replaced(text, "\n", " "), 1, 5, 6);
  expect_triangles(replaced(text, " a\n", "\n"), 1, 5, 6);  // without a name
}

TEST_F(Stl, ReadsCommentsAndATextWithoutItsFirstLine) {
  const std::string text = solid("a", 5);
  for (const std::string comment : {"# solid by a tool 1.2\n", "! vertex 9 9 9\r\n", "  $ endloop\n#\n"}) {
    expect_triangles(comment + text, 1, 5, 6);
    expect_triangles(replaced(text, "outer loop\n", "outer loop\n" + comment), 1, 5, 6);
  }
  expect_triangles(text.substr(text.find("facet")), 1, 5, 6);
}

TEST_F(Stl, ReadsAllSolidsOfAText) {
  const std::string three =
      solid("bow", 0) + solid("stern post", 10) + "solid empty\nendsolid empty\n" + solid("bow", 20);
  expect_triangles("  " + three, 3, 0, 21);
  expect_triangles(in_capitals(three), 3, 0, 21);
  expect_triangles(three, 1, 10, 11, "stern post");
  expect_triangles(three, 2, 0, 21, "bow");
  EXPECT_THAT(error_of(three, "keel"),
              HasSubstr("no submesh 'keel' with triangles; names in the file: bow, stern "
                        "post, empty"));
  EXPECT_THAT(error_of("solid empty\nendsolid empty\n"), HasSubstr("hull.stl: the mesh has no triangles"));
}

TEST_F(Stl, SplitsAFacetOfFourCorners) {
  const MeshFile file = load(
      "solid q\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 2 0\nvertex 0 2 "
      "0\nendloop\n"
      "endfacet\nendsolid q\n");
  EXPECT_EQ(file.parts.at(0).mesh->triangle_count(), 2U);
  EXPECT_NEAR(test::area_m2(*file.parts[0].mesh), 2.0, 1e-6);
}

TEST_F(Stl, TakesAFileOfTheSizeOfABinaryOneForBinary) {
  expect_triangles(binary("exported by hand", 3), 3, 0, 3);
  expect_triangles(binary("solid exported by hand", 3), 3, 0, 3);
  expect_triangles(binary("SOLID", 1), 1, 0, 1);
  expect_triangles(binary("solid in the header, notes behind", 2) + "notes", 2, 0, 2);
}

TEST_F(Stl, NamesTheTrueCause) {
  const std::string three = binary("exported by hand", 3);
  EXPECT_THAT(error_of(three.substr(0, 200)),
              HasSubstr("hull.stl: the file is cut short: 3 triangles need 234 bytes, there are 200"));
  EXPECT_THAT(error_of(binary("solid exported by hand", 3).substr(0, 233)),
              HasSubstr("hull.stl: the file is cut short: 3 triangles need 234 bytes, there are 233"));
  for (const std::string& other : {std::string(), std::string("solidify"), std::string("v 0 0 0\nv 1 0 0\n"),
                                   std::string(500, 'x'), std::string(84 + 50, '\0'), three.substr(0, 40)}) {
    EXPECT_THAT(error_of(other), HasSubstr("hull.stl: neither a text STL")) << other.substr(0, 20);
  }
  const std::string text = solid("a", 5);
  EXPECT_THAT(error_of(text.substr(0, text.find("endloop"))),
              HasSubstr("hull.stl: the file is cut short: it ends inside a facet"));
  EXPECT_THAT(error_of(text.substr(0, text.find(" 2 0\n"))),
              HasSubstr("hull.stl: the file is cut short: it ends inside a facet"));
  EXPECT_THAT(error_of(replaced(text, " 2 0\n", " 2 blah\n")),
              HasSubstr("hull.stl: line 6: 'blah' is not a number"));
  EXPECT_THAT(error_of(replaced(text, "vertex 5 2 0\n", "corner 5 2 0\n")),
              HasSubstr("hull.stl: line 7: a facet has 2 corners, expected 3"));
}

TEST_F(Stl, CountsTrianglesThatAreNotMadeOfNumbers) {
  const MeshFile file = load(solid("a", 5) + replaced(solid("b", 7), " 2 0\n", " nan 0\n"));
  EXPECT_EQ(file.parts.at(0).mesh->triangle_count(), 1U);
  EXPECT_EQ(file.diagnostics.non_finite_triangles, 1U);
}

}  // namespace
}  // namespace sonard::render
