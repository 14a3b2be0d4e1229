// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/mesh_file.hpp"

#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

const std::filesystem::path worlds_data = std::filesystem::path(SONARD_SOURCE_DIR) / "tests/data/worlds";

MeshFileRequest request_for(const std::filesystem::path& file) {
  MeshFileRequest request;
  request.file = file;
  return request;
}

std::string error_of(const MeshFileRequest& request) {
  try {
    load_mesh_file(request);
  } catch (const WorldError& error) {
    return error.what();
  }
  return "";
}

double volume_m3(const MeshFile& file) {
  double sum = 0.0;
  for (const MeshFilePart& part : file.parts) {
    sum += test::volume_m3(*part.mesh);
  }
  return sum;
}

std::size_t triangle_count(const MeshFile& file) {
  std::size_t sum = 0;
  for (const MeshFilePart& part : file.parts) {
    sum += part.mesh->triangle_count();
  }
  return sum;
}

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class TetrahedronFile : public testing::TestWithParam<const char*> {};

// Corners (0 0 0) (1 0 0) (0 2 0) (0 0 3): volume 1, wound outward, axes as in the file.
TEST_P(TetrahedronFile, KeepsItsAxesSizeAndWinding) {
  const MeshFile file = load_mesh_file(request_for(worlds_data / GetParam()));
  EXPECT_EQ(triangle_count(file), 4U);
  EXPECT_NEAR(volume_m3(file), 1.0, 1e-6);
  glm::dvec3 high(0.0);
  for (const MeshFilePart& part : file.parts) {
    high = glm::max(high, test::bounds(*part.mesh).high);
    for (std::size_t i = 0; i < part.mesh->normals.size(); ++i) {
      EXPECT_NEAR(glm::length(part.mesh->normals[i]), 1.0, 1e-6);
    }
  }
  EXPECT_EQ(high, glm::dvec3(1.0, 2.0, 3.0));
  EXPECT_TRUE(file.warnings.empty());
}

INSTANTIATE_TEST_SUITE_P(Formats, TetrahedronFile,
                         testing::Values("tetrahedron.obj", "tetrahedron.ply", "tetrahedron.stl",
                                         "tetrahedron.osgt"));

TEST(MeshFile, SplitsAnObjByMaterialName) {
  const MeshFile file = load_mesh_file(request_for(worlds_data / "tetrahedron.obj"));
  std::vector<std::string> names;
  for (const MeshFilePart& part : file.parts) {
    names.push_back(part.material_name);
    EXPECT_EQ(part.mesh->triangle_count(), 2U);
  }
  EXPECT_THAT(names, UnorderedElementsAre("steel", "Rock.001"));
}

TEST(MeshFile, AppliesTheUnitAndTransformsOfCollada) {
  const MeshFile file = load_mesh_file(request_for(worlds_data / "millimetres.dae"));
  ASSERT_EQ(file.parts.size(), 1U);
  EXPECT_EQ(file.parts[0].material_name, "steel");
  EXPECT_NEAR(volume_m3(file), 1.0, 1e-6);
  const test::Bounds box = test::bounds(*file.parts[0].mesh);
  EXPECT_NEAR(glm::distance(box.low, glm::dvec3(0.0, 0.0, 0.5)), 0.0, 1e-6);
  EXPECT_NEAR(glm::distance(box.high, glm::dvec3(1.0, 2.0, 3.5)), 0.0, 1e-6);
}

TEST(MeshFile, RefusesAColladaUnitThatIsNoNumber) {
  const test::TempFolder folder;
  std::string text = content(worlds_data / "millimetres.dae");
  text.replace(text.find("0.001"), 5, "-1e-3");
  EXPECT_THAT(error_of(request_for(folder.write("unit.dae", text))),
              HasSubstr("unit.dae: <unit meter=\"-1e-3\">"));
}

TEST(MeshFile, InventsNoNormals) {
  // Smooth normals over the edges of a box would give it the echo of a ball.
  EXPECT_TRUE(load_mesh_file(request_for(worlds_data / "tetrahedron.ply")).parts.at(0).mesh->normals.empty());
  EXPECT_TRUE(load_mesh_file(request_for(worlds_data / "tetrahedron.stl")).parts.at(0).mesh->normals.empty());
  for (const MeshFilePart& part : load_mesh_file(request_for(worlds_data / "tetrahedron.obj")).parts) {
    for (std::size_t t = 0; t < part.mesh->triangle_count(); ++t) {
      const glm::dvec3 facing = glm::normalize(test::area_normal(*part.mesh, t));
      for (std::size_t k = 0; k < 3 && !part.mesh->normals.empty(); ++k) {
        EXPECT_NEAR(glm::dot(facing, glm::dvec3(part.mesh->normals[part.mesh->indices[3 * t + k]])), 1.0,
                    1e-5);
      }
    }
  }
}

TEST(MeshFile, KeepsTheNormalsOfTheFile) {
  const test::TempFolder folder;
  const MeshFile obj = load_mesh_file(request_for(folder.write(
      "smooth.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0.6 0 0.8\nvn 0 0.6 0.8\nvn 0 0 2\nf 1//1 2//2 3//3\n")));
  ASSERT_EQ(obj.parts.at(0).mesh->normals.size(), 3U);
  EXPECT_NEAR(glm::distance(obj.parts[0].mesh->normals[0], glm::vec3(0.6F, 0, 0.8F)), 0.0, 1e-6);
  EXPECT_NEAR(glm::distance(obj.parts[0].mesh->normals[2], glm::vec3(0, 0, 1)), 0.0, 1e-6);
  const MeshFile ply = load_mesh_file(request_for(folder.write(
      "smooth.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0 0.6 0 0.8\n1 0 0 0 0.6 0.8\n0 1 0 0 0 1\n3 0 1 2\n")));
  ASSERT_EQ(ply.parts.at(0).mesh->normals.size(), 3U);
  EXPECT_NEAR(glm::distance(ply.parts[0].mesh->normals[0], glm::vec3(0.6F, 0, 0.8F)), 0.0, 1e-6);
}

TEST(MeshFile, RefusesATextPlyWithoutNumbers) {
  const test::TempFolder folder;
  for (const std::string vertex : {"nan nan nan", "0 inf 0", "-Infinity 0 0"}) {
    const std::string error = error_of(request_for(folder.write(
        "bad.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n" +
            vertex + "\n3 0 1 2\n")));
    EXPECT_THAT(error,
                HasSubstr("bad.ply: line 12: '" + vertex + "' has values that are not finite numbers"));
  }
}

TEST(MeshFile, ScalesAndMirrors) {
  MeshFileRequest request = request_for(worlds_data / "tetrahedron.obj");
  request.scale = {2.0, 1.0, -0.5};
  const MeshFile file = load_mesh_file(request);
  EXPECT_NEAR(volume_m3(file), 1.0, 1e-6);  // positive: the winding was turned with the mirror
  glm::dvec3 low(0.0);
  for (const MeshFilePart& part : file.parts) {
    low = glm::min(low, test::bounds(*part.mesh).low);
    for (std::size_t t = 0; t < part.mesh->triangle_count(); ++t) {
      for (std::size_t k = 0; k < 3 && !part.mesh->normals.empty(); ++k) {
        EXPECT_NEAR(glm::dot(glm::normalize(test::area_normal(*part.mesh, t)),
                             glm::dvec3(part.mesh->normals[part.mesh->indices[3 * t + k]])),
                    1.0, 1e-5);
      }
    }
  }
  EXPECT_EQ(low, glm::dvec3(0.0, 0.0, -1.5));
  request.scale = {1.0, 0.0, 1.0};
  EXPECT_THAT(error_of(request), HasSubstr("scale 1 0 1"));
}

TEST(MeshFile, TakesOneSubmesh) {
  MeshFileRequest request = request_for(worlds_data / "tetrahedron.obj");
  request.submesh = "cap";
  const MeshFile file = load_mesh_file(request);
  ASSERT_EQ(file.parts.size(), 1U);
  EXPECT_EQ(file.parts[0].material_name, "Rock.001");
  EXPECT_EQ(test::bounds(*file.parts[0].mesh).high, glm::dvec3(1.0, 2.0, 3.0));
  request.center_submesh = true;
  EXPECT_EQ(test::bounds(*load_mesh_file(request).parts.at(0).mesh).high, glm::dvec3(0.5, 1.0, 1.5));
  request.submesh = "keel";
  EXPECT_THAT(error_of(request), testing::AllOf(HasSubstr("no submesh 'keel'"), HasSubstr("hull")));
}

TEST(MeshFile, TakesASubmeshOfCollada) {
  MeshFileRequest request = request_for(worlds_data / "millimetres.dae");
  request.submesh = "tetrahedron_node";
  EXPECT_EQ(triangle_count(load_mesh_file(request)), 4U);
}

TEST(MeshFile, MakesTangentsForANormalMap) {
  const test::TempFolder folder;
  MeshFileRequest request = request_for(folder.write(
      "quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"));
  request.tangents = true;
  const MeshFile file = load_mesh_file(request);
  const TriangleMesh& mesh = *file.parts.at(0).mesh;
  ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
  for (const glm::vec4& tangent : mesh.tangents) {
    EXPECT_NEAR(glm::distance(tangent, glm::vec4(1, 0, 0, 1)), 0.0, 1e-6);
  }
  // Without texture coordinates the mesh is used without its normal map.
  request.file = worlds_data / "tetrahedron.obj";
  const MeshFile bare = load_mesh_file(request);
  EXPECT_EQ(triangle_count(bare), 4U);
  EXPECT_TRUE(bare.parts.at(0).mesh->tangents.empty());
  EXPECT_THAT(bare.warnings,
              testing::ElementsAre(HasSubstr("tetrahedron.obj: the normal map is left out on")));
}

TEST(MeshFile, CountsWhatItDrops) {
  const test::TempFolder folder;
  const MeshFile file = load_mesh_file(request_for(folder.write(
      "soup.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n")));
  EXPECT_EQ(triangle_count(file), 1U);
  EXPECT_EQ(file.diagnostics.degenerate_triangles + file.diagnostics.non_finite_triangles, 2U);
}

TEST(MeshFile, WarnsOfCoordinatesThatFloatsCannotHold) {
  const test::TempFolder folder;
  const MeshFile file = load_mesh_file(request_for(
      folder.write("utm.obj", "v 500000 4000000 0\nv 500100 4000000 0\nv 500000 4000100 0\nf 1 2 3\n")));
  ASSERT_EQ(file.warnings.size(), 1U);
  EXPECT_THAT(file.warnings[0], HasSubstr("utm.obj"));
}

TEST(MeshFile, KeepsTheNameOfAMaterialThatNothingDefines) {
  const test::TempFolder folder;
  const MeshFile file = load_mesh_file(request_for(
      folder.write("lost.obj", "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl steel\nf 1 2 3\n")));
  ASSERT_EQ(file.parts.size(), 1U);
  EXPECT_EQ(file.parts[0].material_name, "steel");
  EXPECT_TRUE(file.warnings.empty());
}

TEST(MeshFile, RefusesWhatItShould) {
  const test::TempFolder folder;
  EXPECT_THAT(error_of(request_for("/nowhere/hull.obj")),
              HasSubstr("/nowhere/hull.obj: mesh file not found"));
  EXPECT_THAT(error_of(request_for("hull.obj")), HasSubstr("not found"));
  EXPECT_THAT(error_of(request_for("http://127.0.0.1:9/hull.obj")), HasSubstr("sonard downloads nothing"));
  EXPECT_THAT(error_of(request_for(folder.write("hull.blend", "x"))),
              HasSubstr("supported: obj, stl, ply, dae"));
  EXPECT_THAT(error_of(request_for(folder.write("cube.obj.2.scale", "x"))), HasSubstr("supported:"));
  EXPECT_THAT(error_of(request_for(folder.path())), HasSubstr("not a file"));
  EXPECT_THAT(error_of(request_for(folder.write("empty.obj", ""))), HasSubstr("empty.obj: "));
  EXPECT_THAT(error_of(request_for(folder.write("points.obj", "v 0 0 0\nv 1 1 1\n"))),
              HasSubstr("points.obj: "));
  EXPECT_THAT(error_of(request_for(folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"))),
              HasSubstr("no triangles"));
}

/// A binary STL of a regular grid of 2 (n - 1)^2 triangles.
std::string stl_grid(int n) {
  std::string bytes(80, ' ');
  const auto put = [&bytes](const auto& value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  };
  put(static_cast<std::uint32_t>(2 * (n - 1) * (n - 1)));
  const auto vertex = [&](int x, int y) {
    put(static_cast<float>(x));
    put(static_cast<float>(y));
    put(0.1F * std::sin(static_cast<float>(x * y)));
  };
  for (int y = 0; y + 1 < n; ++y) {
    for (int x = 0; x + 1 < n; ++x) {
      for (int half = 0; half < 2; ++half) {
        put(0.0F), put(0.0F), put(1.0F);
        vertex(x, y);
        vertex(x + 1, y + half);
        vertex(x + 1 - half, y + 1);
        put(std::uint16_t{0});
      }
    }
  }
  return bytes;
}

TEST(MeshFile, ReadsALargeStlInSeconds) {
  const test::TempFolder folder;
  const auto file = folder.write("grid.stl", stl_grid(160));
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(triangle_count(load_mesh_file(request_for(file))), 50562U);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(MeshFile, RefusesATruncatedBinaryStl) {
  const test::TempFolder folder;
  const std::string whole = stl_grid(4);
  EXPECT_THAT(error_of(request_for(folder.write("cut.stl", whole.substr(0, whole.size() - 1)))),
              HasSubstr("cut.stl: the file is cut short"));
}

// The plugins crash, loop or stop half way on some of these. The result must be an error or a valid mesh.
TEST(MeshFile, SurvivesDamagedFiles) {
  const test::TempFolder folder;
  int refused = 0;
  for (const char* name :
       {"tetrahedron.obj", "tetrahedron.ply", "tetrahedron.stl", "tetrahedron.osgt", "millimetres.dae"}) {
    const std::string whole = content(worlds_data / name);
    for (std::size_t i = 1; i < 24; ++i) {
      std::string damaged = whole.substr(0, whole.size() * i / 24);
      if (i % 2 == 0) {
        damaged = whole;
        damaged[whole.size() * i / 24] = static_cast<char>(0x30 + i);
      }
      const auto file = folder.write("damaged" + std::filesystem::path(name).extension().string(), damaged);
      try {
        for (const MeshFilePart& part : load_mesh_file(request_for(file)).parts) {
          for (const std::uint32_t index : part.mesh->indices) {
            ASSERT_LT(index, part.mesh->positions.size());
          }
        }
      } catch (const WorldError& error) {
        EXPECT_THAT(error.what(), HasSubstr("damaged."));
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace sonard::render
