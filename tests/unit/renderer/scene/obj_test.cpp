// SPDX-License-Identifier: Apache-2.0
// OBJ files in all forms that the format allows (Wavefront, Advanced Visualizer, appendix B1), and damaged
// ones. Boxes, areas and texture coordinates are computed by hand.
#include <sys/stat.h>

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/mesh_file.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

class Obj : public testing::Test {
 protected:
  MeshFile load(const std::string& text, const std::string& submesh = "") const {
    MeshFileRequest request;
    request.file = folder_.write("hull.obj", text);
    request.submesh = submesh;
    return load_mesh_file(request);
  }

  std::string error_of(const std::string& text) const {
    try {
      load(text);
    } catch (const WorldError& error) {
      return error.what();
    }
    return "no error";
  }

  test::TempFolder folder_;
};

std::vector<std::string> materials_of(const MeshFile& file) {
  std::vector<std::string> names;
  for (const MeshFilePart& part : file.parts) {
    names.push_back(part.material_name);
  }
  return names;
}

/// The two triangles of a square whose third corner is at height z, without the vertex at (9, 9, 9).
void expect_square(const MeshFile& file, double z) {
  ASSERT_EQ(file.parts.size(), 1U);
  const TriangleMesh& mesh = *file.parts[0].mesh;
  EXPECT_EQ(mesh.triangle_count(), 2U);
  EXPECT_NEAR(glm::distance(test::corner(mesh, 2), glm::dvec3(1, 1, z)), 0.0, 1e-6);
  EXPECT_NEAR(glm::distance(test::corner(mesh, 5), glm::dvec3(0, 1, 0)), 0.0, 1e-6);
  EXPECT_THAT(file.warnings, IsEmpty());
}

// ---- numbers

TEST_F(Obj, ReadsNumbersInEveryForm) {
  for (const auto& [number, z] :
       std::vector<std::pair<std::string, double>>{{"0.5", 0.5},
                                                   {".5", 0.5},
                                                   {"+.5", 0.5},
                                                   {"+0.5", 0.5},
                                                   {"-.5", -0.5},
                                                   {"2.", 2},
                                                   {"-2.", -2},
                                                   {"5e-1", 0.5},
                                                   {".5E+0", 0.5},
                                                   {"-.05e1", -0.5},
                                                   {"0,5", 0.5},
                                                   {"0.500000000000000000000", 0.5},
                                                   {"0.000000000000000005e17", 0.5}}) {
    SCOPED_TRACE(number);
    expect_square(
        load(fmt::format("v 0 0 0\nv 1 0 0\nv 1 1 {}\nv 0 1 0\nv 9 9 9\nf 1 2 3\nf 1 3 4\n", number)), z);
    expect_square(
        load(fmt::format("v .0 0. +0\nv 1. +.0 0\nv 1 1 {}\nv -.0 1.e0 0\nf 1 2 3\nf 1 3 4\n", number)), z);
  }
}

// The weight of a vertex is for curves, its colour for pictures.
TEST_F(Obj, TakesThreeCoordinatesOfAVertex) {
  for (const char* const more : {"2", "0", ".5 .5 .5", "1 .5 .5 .5", "red"}) {
    SCOPED_TRACE(more);
    expect_square(
        load(fmt::format("v 0 0 0 {0}\nv 1 0 0 {0}\nv 1 1 .5 {0}\nv 0 1 0 {0}\nf 1 2 3\nf 1 3 4\n", more)),
        0.5);
  }
}

TEST_F(Obj, NamesTheLineOfABadVertex) {
  for (const auto& [vertex, word] :
       std::vector<std::pair<std::string, std::string>>{{"v 1 0", ""},
                                                        {"v", ""},
                                                        {"v 1 x 0", "x"},
                                                        {"v 1 0 0.5f", "0.5f"},
                                                        {"v 1 1.#QNAN 0", "1.#QNAN"},
                                                        {"v 1,0,0", "1,0,0"},
                                                        {"v 1 0 # 0", ""}}) {
    EXPECT_THAT(error_of("# a hull\nv 0 0 0\n" + vertex + "\nv 0 1 0\nf 1 2 3\n"),
                EndsWith(fmt::format("hull.obj: line 3: a vertex with '{}' (expected three numbers)", word)));
  }
}

// As in other formats, triangles of a vertex that is not a number are dropped and counted.
TEST_F(Obj, DropsTrianglesOfAVertexThatIsNotANumber) {
  for (const char* const number : {"nan", "-nan", "inf", "-inf"}) {
    const MeshFile file = load(fmt::format("{}v {} 0 0\nf 1 2 3\nf 1 2 5\n", corners, number));
    EXPECT_EQ(file.parts.at(0).mesh->triangle_count(), 1U) << number;
    EXPECT_EQ(file.diagnostics.non_finite_triangles, 1U) << number;
  }
}

// ---- lines

TEST_F(Obj, EndsLinesAtComments) {
  expect_square(load("#\n# v 7 7 7\nv 0 0 0 # first\nv 1 0 0# second\nv 1 1 .5 #3\n#v 8 8 8\nv 0 1 0\t#\n"
                     "vn 0 0 1 # up\nvt 0 0 # corner\nf 1/1/1 2/1/1 3/1/1 # x\nf 1//1 3//1 4//1#y\n"),
                0.5);
}

TEST_F(Obj, JoinsContinuedLines) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text =
        "# not continued \\\nv 0 0 0\nv \\\n1 0 0\nv 1 1\\\n .5\nv 0 \\\n 1 \\\n 0\nf 1 \\\n2 \\\n3\nf 1 3 "
        "4\\\n";
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + end.size())) {
      text.replace(at, 1, end);
    }
    expect_square(load(text), 0.5);
  }
  EXPECT_THAT(error_of("v 0 0 0\nv 1 \\\n0 \\\n0\nv 0 1\nf 1 2 3\n"), HasSubstr("hull.obj: line 5: "));
}

TEST_F(Obj, MayBeIndented) {
  expect_square(load("  v 0 0 0\n\tv\t1\t0\t0  \n v   1 1  .5\nv 0 1 0\n\n   f 1 2 3\n\tf\t1\t3\t4\n"), 0.5);
}

TEST_F(Obj, MayHoldLinesWithoutASurface) {
  expect_square(
      load("mg 1\ns off\nvp 0 0\nlod 1\n" + corners +
           "p 1 x\nl 1 9 # a line\nf 1 2 3\nf 1 3 4\ncstype bezier\ncall other.obj\n" + "usemap x\n"),
      0.0);
}

TEST_F(Obj, MayHaveNoFaces) {
  for (const std::string& text :
       {std::string(), corners, corners + "l 1 2\np 1\n", corners + "f 1 2\nf 3\nf\n",
        std::string("V 0 0 0\nV 1 0 0\nV 1 1 1\nF 1 2 3\n")}) {
    EXPECT_THAT(error_of(text), EndsWith("hull.obj: the mesh has no triangles")) << text;
  }
  expect_square(load(corners + "f 1 2\nf 1 2 3\nf 1\nf 1 3 4\n"), 0.0);
}

// ---- faces

TEST_F(Obj, CountsIndicesFromBothEnds) {
  expect_square(load("v 0 0 0\nv 1 0 0\nv 1 1 .5\nf -3 -2 -1\nv 0 1 0\nf -4 -2 -1\nv 9 9 9\n"), 0.5);
  expect_square(load(corners + "fo 1 2 3\nfo 1 3 4\n"), 0.0);  // the former word for f
  expect_square(load("f 1 2 3\nf 1 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 .5\nv 0 1 0\n"), 0.5);
}

TEST_F(Obj, NamesTheLineOfAFaceWithoutItsVertex) {
  for (const char* const corner : {"0", "5", "-5", "99999999999999999999", "x", "1.5", "/1", "1,2"}) {
    EXPECT_THAT(
        error_of(corners + "f 1 2 3\nf 1 3 " + corner + "\n"),
        EndsWith(fmt::format("hull.obj: line 6: a face with the corner '{}' (expected one of the 4 vertices)",
                             corner)));
  }
}

// ---- texture coordinates and normals

std::vector<std::pair<float, float>> texcoords_of(const MeshFile& file) {
  std::vector<std::pair<float, float>> texcoords;
  for (const glm::vec2& t : file.parts.at(0).mesh->texcoords) {
    texcoords.emplace_back(t.x, t.y);
  }
  return texcoords;
}

TEST_F(Obj, ReadsTextureCoordinatesInEveryForm) {
  const MeshFile file =
      load(corners + "vt .5 -.25 # two\nvt 0.75\nvt +1. 5e-1 .125\nf 1/1 2/2 3/3\nf 1/-3 2/-2/ 3/-1\n");
  const std::vector<std::pair<float, float>> face{{0.5F, -0.25F}, {0.75F, 0.0F}, {1.0F, 0.5F}};
  ASSERT_EQ(texcoords_of(file).size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(texcoords_of(file)[i], face[i % 3]) << i;
  }
  EXPECT_THAT(file.warnings, IsEmpty());
}

TEST_F(Obj, LosesOnlyBadTextureCoordinates) {
  for (const char* const bad : {"vt x .5", "vt", "vt .5 y", "vt nan 0", "vt -1.#IND 0", "vt 0 inf"}) {
    const MeshFile file = load(corners + "vt .5 .25\n" + bad + "\nvt 1 1\nf 1/1 2/2 3/3\n");
    EXPECT_THAT(texcoords_of(file),
                ElementsAre(std::pair(0.5F, 0.25F), std::pair(0.0F, 0.0F), std::pair(1.0F, 1.0F)))
        << bad;
    EXPECT_THAT(file.warnings,
                ElementsAre(HasSubstr("hull.obj: line 6: bad texture coordinates or normals are left out")))
        << bad;
  }
}

TEST_F(Obj, LosesOnlyReferencesToWhatIsMissing) {
  for (const char* const bad : {"9/1", "0/1", "-3/1", "x/1", "1.5/1"}) {
    const MeshFile file =
        load(corners + "vt .5 .25\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1\nf 1/1/1 3/" + bad + " 4/2/1\n");
    EXPECT_THAT(texcoords_of(file),
                ElementsAre(std::pair(0.5F, 0.25F), std::pair(1.0F, 1.0F), std::pair(0.5F, 0.25F),
                            std::pair(0.5F, 0.25F), std::pair(0.0F, 0.0F), std::pair(1.0F, 1.0F)))
        << bad;
    EXPECT_EQ(file.parts.at(0).mesh->normals.size(), 6U) << bad;
    EXPECT_EQ(file.diagnostics.bad_normals, 0U) << bad;
    EXPECT_THAT(file.warnings, ElementsAre(AllOf(HasSubstr("hull.obj: line 9: "), HasSubstr("(lines: 1)"))))
        << bad;
  }
}

TEST_F(Obj, TakesTheGeometricNormalForABadOne) {
  for (const char* const bad : {"vn 0 0", "vn a 0 1", "vn nan 0 1", "vn -1.#IND -1.#IND -1.#IND"}) {
    const MeshFile file = load(corners + "vn .6 0 .8\n" + bad + "\nf 1//1 2//2 3//1\nf 1//7 3//2 4//1\n");
    const std::vector<glm::vec3>& normals = file.parts.at(0).mesh->normals;
    ASSERT_EQ(normals.size(), 6U) << bad;
    EXPECT_LT(glm::distance(normals[0], glm::vec3(0.6F, 0, 0.8F)), 1e-6F) << bad;
    for (const std::size_t i : {1, 3, 4}) {
      EXPECT_LT(glm::distance(normals[i], glm::vec3(0, 0, 1)), 1e-6F) << bad << ' ' << i;
    }
    EXPECT_EQ(file.diagnostics.bad_normals, 3U) << bad;
    EXPECT_THAT(file.warnings, ElementsAre(HasSubstr("hull.obj: line 6: "))) << bad;
  }
}

TEST_F(Obj, MayHaveAttributesOnSomeCornersOnly) {
  const MeshFile file = load(corners + "vt .5 .25\nvt 1 1\nf 1/1 2 3/2\n");
  EXPECT_THAT(texcoords_of(file),
              ElementsAre(std::pair(0.5F, 0.25F), std::pair(0.0F, 0.0F), std::pair(1.0F, 1.0F)));
  EXPECT_THAT(file.warnings, ElementsAre(HasSubstr("hull.obj: line 7: ")));
  const MeshFile bare = load(corners + "f 1/1/1 2/2/2 3/3/3\n");
  EXPECT_THAT(texcoords_of(bare), IsEmpty());
  EXPECT_THAT(bare.parts.at(0).mesh->normals, IsEmpty());
  EXPECT_EQ(bare.parts.at(0).mesh->triangle_count(), 1U);
}

// ---- names

TEST_F(Obj, KeepsNames) {
  const std::string text = corners +
                           "o Hull #1\ng a b\nusemtl Material #25\nf 1 2 3\n usemtl \t two words \nf 1 3 4\n"
                           "o lid\nusemtl steel\nf 1 2 4\n";
  EXPECT_THAT(materials_of(load(text)), testing::UnorderedElementsAre("Material #25", "two words", "steel"));
  EXPECT_THAT(materials_of(load(text, "lid")), ElementsAre("steel"));
}

TEST_F(Obj, GivesAFaceTheMaterialBeforeIt) {
  const MeshFile file = load(corners + "f 1 2 4\nusemtl steel\nf 1 2 3\nf 1 3 4\n");
  ASSERT_THAT(materials_of(file), ElementsAre("", "steel"));
  EXPECT_EQ(file.parts[0].mesh->triangle_count(), 1U);
  EXPECT_EQ(file.parts[1].mesh->triangle_count(), 2U);
}

// usemtl gives the names, so a library is not read, whatever it is.
TEST_F(Obj, NeedsNoMaterialLibrary) {
  for (const char* const library : {"newmtl steel\nKd spectral x.rfl 1\n", "newmtl steel\nKd\nd\nillum\n",
                                    "newmtl\nKd 1,0 0 0\n", "\x01\x02"}) {
    folder_.write("hull.mtl", library);
    const MeshFile file = load("mtllib hull.mtl\n" + corners + "f 1 2 4\nusemtl steel\nf 1 2 3\n");
    EXPECT_THAT(materials_of(file), testing::UnorderedElementsAre("steel", "")) << library;
    EXPECT_THAT(file.warnings, IsEmpty()) << library;
  }
  ASSERT_EQ(::mkfifo((folder_.path() / "pipe.mtl").c_str(), 0600), 0);
  for (const char* const name :
       {"pipe.mtl", "/etc/passwd", "../../secret.mtl", "gone.mtl", ".", "C:\\a.mtl"}) {
    EXPECT_THAT(materials_of(load(fmt::format("mtllib {}\n{}usemtl steel\nf 1 2 3\n", name, corners))),
                ElementsAre("steel"))
        << name;
  }
}

}  // namespace
}  // namespace sonard::render
