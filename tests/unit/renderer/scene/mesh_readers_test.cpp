// SPDX-License-Identifier: Apache-2.0
// The triangles that the reader of each format finds. Counts, boxes and names are taken from the files by
// hand.
#include "renderer/scene/mesh_readers.hpp"

#include <algorithm>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <glm/common.hpp>

#include "renderer/scene/mesh_file.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::ElementsAre;
using testing::IsSupersetOf;

const std::filesystem::path source_folder = SONARD_SOURCE_DIR;

struct Truth {
  std::string file;
  std::size_t triangles;
  glm::dvec3 low_m, high_m;
  std::set<std::string> materials{""};
  std::vector<std::string> names{};  ///< of nodes, meshes or solids
};

void PrintTo(const Truth& truth, std::ostream* out) {
  *out << truth.file;
}

std::size_t triangles_in(const MeshFile& file) {
  std::size_t count = 0;
  for (const MeshFilePart& part : file.parts) {
    count += part.mesh->triangle_count();
  }
  return count;
}

class MeshReaders : public testing::TestWithParam<Truth> {};

TEST_P(MeshReaders, FindAllTriangles) {
  const Truth& truth = GetParam();
  MeshFileRequest request;
  request.file = source_folder / truth.file;
  const MeshFile file = load_mesh_file(request);
  test::Bounds box;
  std::set<std::string> materials;
  for (const MeshFilePart& part : file.parts) {
    materials.insert(part.material_name);
    box.low = glm::min(box.low, test::bounds(*part.mesh).low);
    box.high = glm::max(box.high, test::bounds(*part.mesh).high);
  }
  EXPECT_EQ(triangles_in(file), truth.triangles);
  EXPECT_LT(glm::distance(box.low, truth.low_m), 1e-5) << box.low.x << ' ' << box.low.y << ' ' << box.low.z;
  EXPECT_LT(glm::distance(box.high, truth.high_m), 1e-5)
      << box.high.x << ' ' << box.high.y << ' ' << box.high.z;
  EXPECT_EQ(materials, truth.materials);
  EXPECT_THAT(file.warnings, testing::IsEmpty());
  EXPECT_THAT(read_mesh({request.file}).names, IsSupersetOf(truth.names));
}

const std::string shipped = "configs/worlds/meshes/", worlds = "tests/data/worlds/",
                  models = "tests/data/public_worlds/models/", shelf = "tests/data/public_worlds/shelf/";

INSTANTIATE_TEST_SUITE_P(
    Files, MeshReaders,
    testing::Values(
        Truth{worlds + "tetrahedron.obj", 4, {0, 0, 0}, {1, 2, 3}, {"steel", "Rock.001"}, {"hull", "cap"}},
        Truth{worlds + "tetrahedron.osgt", 4, {0, 0, 0}, {1, 2, 3}, {"steel", "Rock.001"}, {"hull", "cap"}},
        Truth{worlds + "tetrahedron.stl", 4, {0, 0, 0}, {1, 2, 3}, {""}, {"tetrahedron"}},
        Truth{worlds + "tetrahedron.ply", 4, {0, 0, 0}, {1, 2, 3}},
        Truth{worlds + "millimetres.dae", 4, {0, 0, .5}, {1, 2, 3.5}, {"steel"}, {"tetrahedron_node"}},
        Truth{worlds + "harbour/models/crane/meshes/jib.obj", 4, {0, 0, 0}, {1, 2, 3}, {""}, {"hull", "cap"}},
        Truth{models + "amphora/meshes/amphora.dae", 288, {-.359999, 0, -.359999}, {.359999, 1.2, .359999}},
        Truth{
            models + "bluerov2/meshes/frame.obj", 60, {-.23, -.17, -.125}, {.23, .17, .125}, {""}, {"frame"}},
        Truth{models + "wreck/meshes/hull.glb", 360, {-6, 0, -1.5}, {6, 2, 1.5}, {"steel_fouled"}, {"hull"}},
        Truth{models + "dock_block/meshes/block.stl", 12, {-1000, -1000, -300}, {1000, 1000, 300}},
        Truth{shelf + "platform/meshes/deck.obj", 2, {-1, -2, 0}, {1, 2, 0}, {""}, {"deck"}},
        Truth{shelf + "sand/meshes/floor.obj", 2, {-20, -20, 0}, {20, 20, 0}, {""}, {"floor"}},
        // Assimp crashes on these two.
        Truth{shipped + "oil_and_gas/jumper.ply", 1076, {2.65, -1.05, -29.187}, {7.63, 3.08, -26.979}},
        Truth{shipped + "oil_and_gas/riser_clamps.ply", 528, {-1.16, -9.9, -20.259}, {1.1, -7.323, -2.759}},
        Truth{shipped + "oil_and_gas/seabed.ply", 12800, {-26, -26, -30.662}, {26, 26, -29.222}}));

/// The number of faces in the header of a PLY. In the shipped files, all faces are triangles.
std::size_t faces_in(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string word;
  while (in >> word && word != "face") {
  }
  std::size_t faces = 0;
  in >> faces;
  return faces;
}

TEST(MeshReaders, FindAllTrianglesOfTheShippedWorlds) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source_folder / shipped)) {
    if (entry.path().extension() == ".ply") {
      MeshFileRequest request;
      request.file = entry.path();
      const MeshFile file = load_mesh_file(request);
      EXPECT_EQ(triangles_in(file) + file.diagnostics.degenerate_triangles, faces_in(entry.path()))
          << entry.path();
      ++files;
    }
  }
  EXPECT_GE(files, 45U);
}

TEST(MeshReaders, AreThereForEveryFormat) {
  EXPECT_THAT(mesh_extensions(),
              ElementsAre("obj", "stl", "ply", "dae", "glb", "gltf", "fbx", "osgt", "osgb", "ive", "3ds"));
}

/// OpenSceneGraph's text of a node with a name, at `x`, with the triangle (x 0 0) (x+1 0 0) (x 2 0), and
/// `below` it.
std::string osg_node(int id, const std::string& name, int x, const std::string& below = "") {
  return fmt::format(
      "osg::MatrixTransform {{\n  UniqueID {0} \n  Name \"{1}\" \n  Children {4} {{\n    osg::Geode {{\n"
      "      UniqueID {5} \n      Drawables 1 {{\n        osg::Geometry {{\n          UniqueID {6} \n"
      "          PrimitiveSetList 1 {{\n            osg::DrawArrays {{\n              UniqueID {7} \n"
      "              Mode TRIANGLES \n              Count 3 \n            }}\n          }}\n"
      "          VertexArray TRUE {{\n            osg::Vec3Array {{\n              UniqueID {8} \n"
      "              Binding BIND_PER_VERTEX \n              vector 3 {{\n                0 0 0 \n"
      "                1 0 0 \n                0 2 0 \n              }}\n            }}\n          }}\n"
      "        }}\n      }}\n    }}\n{3}  }}\n  Matrix {{\n    1 0 0 0 \n    0 1 0 0 \n    0 0 1 0 \n"
      "    {2} 0 0 1 \n  }}\n}}\n",
      id, name, x, below, below.empty() ? 1 : 2, id + 1, id + 2, id + 3, id + 4);
}

TEST(OpenSceneGraphReader, FindsTheGeometryOfANodeBeforeTheNodesBelow) {
  const test::TempFolder folder;
  MeshFileRequest request;
  request.file =
      folder.write("boat.osgt", "#Ascii Scene \n#Version 161 \n#Generator OpenSceneGraph 3.6.5 \n\n" +
                                    osg_node(1, "hull", 10, osg_node(11, "lid", 20)));
  const auto box_of = [&](const std::string& submesh) {
    request.submesh = submesh;
    test::Bounds box;
    for (const MeshFilePart& part : load_mesh_file(request).parts) {
      box.low = glm::min(box.low, test::bounds(*part.mesh).low);
      box.high = glm::max(box.high, test::bounds(*part.mesh).high);
    }
    return std::vector{box.low, box.high};
  };
  EXPECT_THAT(box_of(""), ElementsAre(glm::dvec3(10, 0, 0), glm::dvec3(31, 2, 0)));
  EXPECT_THAT(box_of("hull"), ElementsAre(glm::dvec3(10, 0, 0), glm::dvec3(11, 2, 0)));
  EXPECT_THAT(box_of("lid"), ElementsAre(glm::dvec3(30, 0, 0), glm::dvec3(31, 2, 0)));
}

}  // namespace
}  // namespace sonard::render
