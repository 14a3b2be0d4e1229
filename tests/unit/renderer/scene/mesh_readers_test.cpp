// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/mesh_readers.hpp"

#include <cstdlib>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sonard::render {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

RawMesh one_triangle(const MeshSource& source) {
  RawMesh mesh;
  mesh.add({source.submesh, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {}, {0, 1, 2}}, glm::dmat4(1.0));
  return mesh;
}

RawMesh names_alone(const MeshSource&) {
  RawMesh mesh;
  mesh.names = {"hull"};
  return mesh;
}

RawMesh refuses(const MeshSource&) {
  throw std::runtime_error("line 7 is odd");
}

RawMesh crashes(const MeshSource&) {
  std::abort();
}

RawMesh one_point(const MeshSource&) {
  RawMesh mesh;
  mesh.add({"", {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {}, {}, {0, 1, 2}}, glm::dmat4(1.0));
  return mesh;
}

constexpr MeshReader flat{"flat", one_point};
constexpr MeshReader good{"good", one_triangle};
constexpr MeshReader empty{"empty", names_alone};
constexpr MeshReader strict{"strict", refuses};
constexpr MeshReader broken{"broken", crashes};

TEST(MeshReaders, TakeTheFirstThatFindsTriangles) {
  std::vector<std::string> warnings;
  const MeshReader first[] = {good, broken};
  const RawMesh mesh = read_mesh(first, {"/hull.ply", "lid"}, warnings);
  ASSERT_EQ(mesh.parts.size(), 1U);
  EXPECT_EQ(mesh.parts[0].material_name, "lid");
  const MeshReader second[] = {empty, good};
  EXPECT_EQ(read_mesh(second, {"/hull.ply"}, warnings).parts.size(), 1U);
  const MeshReader third[] = {flat, good};
  EXPECT_EQ(read_mesh(third, {"/hull.ply", "lid"}, warnings).parts.at(0).material_name, "lid")
      << "triangles without an area are none";
  EXPECT_THAT(warnings, IsEmpty());
}

TEST(MeshReaders, SayWhichOneCouldNotReadWhatAnotherRead) {
  std::vector<std::string> warnings;
  const MeshReader readers[] = {strict, broken, good};
  EXPECT_EQ(read_mesh(readers, {"/hull.ply"}, warnings).parts.size(), 1U);
  EXPECT_THAT(
      warnings,
      ElementsAre(
          "/hull.ply: read by good, because strict reports: line 7 is odd; broken reports: the reader "
          "crashed (signal 6): the file is damaged or of another format; check its shape, "
          "or export the mesh again"));
}

TEST(MeshReaders, SayWhatEachSaidIfNoneCanReadTheFile) {
  const auto error_of = [](std::span<const MeshReader> readers) -> std::string {
    std::vector<std::string> warnings;
    try {
      read_mesh(readers, {"/hull.ply"}, warnings);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  const MeshReader two[] = {strict, broken};
  EXPECT_EQ(error_of(two),
            "no reader can read this file: strict reports: line 7 is odd; broken reports: the reader crashed "
            "(signal 6): the file is damaged or of another format");
  const MeshReader one[] = {strict};
  EXPECT_EQ(error_of(one), "line 7 is odd");
}

TEST(MeshReaders, HandBackTheNamesIfNoneFindsTriangles) {
  std::vector<std::string> warnings;
  const MeshReader readers[] = {strict, empty};
  const RawMesh mesh = read_mesh(readers, {"/hull.ply", "lid"}, warnings);
  EXPECT_THAT(mesh.parts, IsEmpty());
  EXPECT_THAT(mesh.names, ElementsAre("hull"));
}

TEST(MeshReaders, AreThereForEveryFormat) {
  EXPECT_EQ(mesh_extensions().size(), 11U);
  for (const std::string_view extension : mesh_extensions()) {
    EXPECT_FALSE(mesh_readers("/HULL." + std::string(extension)).empty()) << extension;
  }
  EXPECT_EQ(mesh_readers("/hull.DAE").front().name, "Assimp");
  EXPECT_TRUE(mesh_readers("/hull.blend").empty());
}

}  // namespace
}  // namespace sonard::render
