// SPDX-License-Identifier: Apache-2.0
// Files of all formats, cut short as by a full disk or a broken download. The libraries of the formats write
// the whole files, which the tests read back first.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <tuple>
#include <vector>

#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>
#include <assimp/Exporter.hpp>
#include <opencv2/imgcodecs.hpp>
#include <osg/Geode>
#include <osg/Geometry>
#include <osgDB/WriteFile>

#include "renderer/scene/image_file.hpp"
#include "renderer/scene/mesh_file.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::HasSubstr;

constexpr unsigned int side = 21;  ///< vertices of a grid along each side
constexpr std::size_t grid_triangles = 2 * (side - 1) * (side - 1);

float height(unsigned int x, unsigned int y) {
  return std::sin(0.7F * static_cast<float>(x)) + std::cos(0.9F * static_cast<float>(y));
}

std::array<unsigned int, 3> corners(unsigned int triangle) {
  const unsigned int cell = triangle / 2;
  const unsigned int a = cell / (side - 1) * side + cell % (side - 1);
  return triangle % 2 == 0 ? std::array{a, a + 1, a + side + 1} : std::array{a, a + side + 1, a + side};
}

/// An Assimp scene owns the objects that it points to.
std::unique_ptr<aiScene> assimp_grid() {
  auto scene = std::make_unique<aiScene>();
  scene->mRootNode = new aiNode("grid");
  scene->mNumMeshes = scene->mNumMaterials = scene->mRootNode->mNumMeshes = 1;
  scene->mMaterials = new aiMaterial* [1] { new aiMaterial };
  scene->mRootNode->mMeshes = new unsigned int[1]{0};
  auto* const mesh = new aiMesh;
  scene->mMeshes = new aiMesh* [1] { mesh };
  mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  mesh->mNumVertices = side * side;
  mesh->mVertices = new aiVector3D[side * side];
  for (unsigned int i = 0; i < side * side; ++i) {
    mesh->mVertices[i] = {static_cast<float>(i % side), static_cast<float>(i / side),
                          height(i % side, i / side)};
  }
  mesh->mNumFaces = grid_triangles;
  mesh->mFaces = new aiFace[grid_triangles];
  for (unsigned int t = 0; t < grid_triangles; ++t) {
    const auto corner = corners(t);
    mesh->mFaces[t].mNumIndices = 3;
    mesh->mFaces[t].mIndices = new unsigned int[3]{corner[0], corner[1], corner[2]};
  }
  return scene;
}

osg::ref_ptr<osg::Node> osg_grid() {
  osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
  osg::ref_ptr<osg::Vec3Array> vertices = new osg::Vec3Array;
  for (unsigned int i = 0; i < side * side; ++i) {
    vertices->push_back(
        {static_cast<float>(i % side), static_cast<float>(i / side), height(i % side, i / side)});
  }
  osg::ref_ptr<osg::DrawElementsUInt> triangles = new osg::DrawElementsUInt(GL_TRIANGLES);
  for (unsigned int t = 0; t < grid_triangles; ++t) {
    for (const unsigned int corner : corners(t)) {
      triangles->push_back(corner);
    }
  }
  geometry->setVertexArray(vertices);
  geometry->addPrimitiveSet(triangles);
  osg::ref_ptr<osg::Geode> geode = new osg::Geode;
  geode->addDrawable(geometry);
  return geode;
}

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

struct MeshFormat {
  const char* name;    ///< of the file
  const char* writer;  ///< Assimp's name of the format; null: OpenSceneGraph writes it
};

void PrintTo(const MeshFormat& format, std::ostream* out) {
  *out << format.name << " by " << (format.writer == nullptr ? "OpenSceneGraph" : format.writer);
}

class CutMesh : public testing::TestWithParam<MeshFormat> {
 protected:
  void SetUp() override {
    const std::string file = folder_.path() / GetParam().name;
    if (GetParam().writer == nullptr) {
      ASSERT_TRUE(osgDB::writeNodeFile(*osg_grid(), file));
    } else {
      Assimp::Exporter exporter;
      ASSERT_EQ(exporter.Export(assimp_grid().get(), GetParam().writer, file), aiReturn_SUCCESS)
          << exporter.GetErrorString();
    }
    whole_ = content(file);
  }

  /// Triangles in the file; 0 if it is refused.
  std::size_t triangles_of(const std::string& bytes) {
    MeshFileRequest request;
    request.file = folder_.write(GetParam().name, bytes);
    try {
      std::size_t count = 0;
      for (const MeshFilePart& part : load_mesh_file(request).parts) {
        count += part.mesh->triangle_count();
      }
      return count;
    } catch (const WorldError& error) {
      complaint_ = error.what();
      return 0;
    }
  }

  test::TempFolder folder_;
  std::string whole_;
  std::string complaint_;
};

TEST_P(CutMesh, IsRefused) {
  ASSERT_EQ(triangles_of(whole_), grid_triangles) << complaint_;
  for (const std::size_t per_mille :
       {20U, 100U, 250U, 400U, 500U, 600U, 700U, 800U, 900U, 970U, 990U, 998U}) {
    const std::size_t kept = whole_.size() * per_mille / 1000;
    const std::size_t count = triangles_of(whole_.substr(0, kept));
    // The end of some formats holds no geometry.
    EXPECT_TRUE(count == 0 || count == grid_triangles)
        << kept << " of " << whole_.size() << " bytes: " << count << " of " << grid_triangles << " triangles";
    EXPECT_TRUE(count != 0 || complaint_.find(GetParam().name) != std::string::npos) << complaint_;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, CutMesh,
                         testing::Values(MeshFormat{"grid.dae", "collada"}, MeshFormat{"grid.stl", "stl"},
                                         MeshFormat{"grid.stl", "stlb"}, MeshFormat{"grid.ply", "ply"},
                                         MeshFormat{"grid.ply", "plyb"}, MeshFormat{"grid.3ds", "3ds"},
                                         MeshFormat{"grid.glb", "glb2"}, MeshFormat{"grid.gltf", "gltf2"},
                                         MeshFormat{"grid.fbx", "fbxa"}, MeshFormat{"grid.osgt", nullptr},
                                         MeshFormat{"grid.osgb", nullptr}, MeshFormat{"grid.ive", nullptr}));

// A .gltf keeps its buffer in another file.
TEST(CutBuffer, IsRefused) {
  const test::TempFolder folder;
  Assimp::Exporter exporter;
  MeshFileRequest request;
  request.file = folder.path() / "grid.gltf";
  ASSERT_EQ(exporter.Export(assimp_grid().get(), "gltf2", request.file.string()), aiReturn_SUCCESS);
  const std::string buffer = content(folder.path() / "grid.bin");
  folder.write("grid.bin", buffer.substr(0, buffer.size() / 2));
  EXPECT_THROW(load_mesh_file(request), WorldError);
}

// An OBJ has no count, but the vertices that its faces name must exist.
TEST(CutObj, IsRefusedIfAFaceNamesAVertexThatIsNotThere) {
  const test::TempFolder folder;
  MeshFileRequest request;
  request.file = folder.write("cut.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
  EXPECT_THROW(load_mesh_file(request), WorldError);
}

TEST(CutCollada, IsRefusedIfNumbersAreMissing) {
  const test::TempFolder folder;
  const std::string whole =
      content(std::filesystem::path(SONARD_SOURCE_DIR) / "tests/data/worlds/millimetres.dae");
  for (const auto& [there, left, sentence] :
       {std::tuple{"0 2 1 0 1 3 0 3 2 1 2 3", "0 2 1 0 1 3", "<triangles> declares 12 indices, there are 6"},
        std::tuple{"0 2000 0 0 0 3000", "0 2000 0", "<float_array> declares 12 numbers, there are 9"}}) {
    std::string cut = whole;
    cut.replace(cut.find(there), std::string(there).size(), left);
    MeshFileRequest request;
    request.file = folder.write("hull.dae", cut);
    try {
      load_mesh_file(request);
      ADD_FAILURE() << sentence;
    } catch (const WorldError& error) {
      EXPECT_THAT(error.what(), HasSubstr(sentence));
    }
  }
}

class CutPicture : public testing::TestWithParam<const char*> {};

TEST_P(CutPicture, IsRefused) {
  const test::TempFolder folder;
  cv::Mat picture(48, 64, CV_8UC3);
  for (int i = 0; i < picture.rows * picture.cols; ++i) {
    picture.at<cv::Vec3b>(i / picture.cols, i % picture.cols) = {static_cast<unsigned char>(i * 37),
                                                                 static_cast<unsigned char>(i * 91 / 7),
                                                                 static_cast<unsigned char>(i)};
  }
  const std::string file = folder.path() / GetParam();
  ASSERT_TRUE(cv::imwrite(file, picture));
  ASSERT_EQ(load_normal_map(file).width_px, 64);
  const std::string whole = content(file);
  for (const std::size_t per_mille : {20U, 250U, 500U, 750U, 900U, 970U, 995U}) {
    folder.write(GetParam(), whole.substr(0, whole.size() * per_mille / 1000));
    try {
      load_normal_map(file);
      ADD_FAILURE() << per_mille << " of 1000 parts were read";
    } catch (const WorldError& error) {
      EXPECT_THAT(error.what(), HasSubstr(GetParam()));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, CutPicture,
                         testing::Values("map.png", "map.jpg", "map.bmp", "map.ppm", "map.tif"));

// Truevision TGA 2.0: a header of 18 bytes, then pixels or packets of them.
TEST(CutTga, IsRefused) {
  const test::TempFolder folder;
  std::string plain(18, '\0');
  plain[2] = 2, plain[12] = 4, plain[14] = 4, plain[16] = 24;
  std::string packed = plain;
  packed[2] = 10;
  plain += std::string(std::size_t{3} * 16, 'x');
  packed += std::string("\x87xyz", 4) + std::string(1, '\x07') + std::string(std::size_t{3} * 8, 'x');
  for (const std::string& whole : {plain, packed}) {
    EXPECT_EQ(load_normal_map(folder.write("map.tga", whole)).width_px, 4);
    EXPECT_THROW(load_normal_map(folder.write("map.tga", whole.substr(0, whole.size() - 1))), WorldError);
  }
}

TEST(CutTextPnm, IsRefused) {
  const test::TempFolder folder;
  EXPECT_EQ(load_grey_image(folder.write("map.pgm", "P2 # by hand\n3 2\n255\n0 1 2\n3 4 5\n")).width_px, 3);
  EXPECT_THROW(load_grey_image(folder.write("map.pgm", "P2 # by hand\n3 2\n255\n0 1 2\n3 4\n")), WorldError);
}

class CutElevations : public testing::TestWithParam<int> {};

// Elevations around 100 m: missing data must not become the bed.
TEST_P(CutElevations, AreRefused) {
  const test::TempFolder folder;
  const std::string file = folder.path() / "bed.tif";
  cv::Mat elevation_m(64, 64, CV_32FC1);
  for (int i = 0; i < 64 * 64; ++i) {
    elevation_m.at<float>(i / 64, i % 64) = 100.0F + 0.01F * static_cast<float>(i * i % 977);
  }
  ASSERT_TRUE(cv::imwrite(file, elevation_m, {cv::IMWRITE_TIFF_COMPRESSION, GetParam()}));
  EXPECT_GE(load_elevation_map(file).lowest_m, 100.0);
  const std::string whole = content(file);
  for (const std::size_t per_mille : {5U, 250U, 500U, 750U, 900U}) {
    folder.write("bed.tif", whole.substr(0, whole.size() * per_mille / 1000));
    EXPECT_THROW(load_elevation_map(file), WorldError) << per_mille;
  }
}

INSTANTIATE_TEST_SUITE_P(Compressions, CutElevations,
                         testing::Values(COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE));

std::string refusal_of_mesh(const std::filesystem::path& file) {
  try {
    MeshFileRequest request;
    request.file = file;
    load_mesh_file(request);
  } catch (const WorldError& error) {
    return error.what();
  }
  return "";
}

std::string refusal_of_picture(const std::filesystem::path& file) {
  try {
    load_grey_image(file);
  } catch (const WorldError& error) {
    return error.what();
  }
  return "";
}

// What a clone without LFS and a failed download leave.
TEST(FileOfAnotherKind, IsNamed) {
  const test::TempFolder folder;
  const std::string pointer =
      "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a214614ab2935c943f9e0\nsize 12345678\n";
  for (const char* const extension : {"obj", "stl", "ply", "dae", "glb", "gltf", "3ds", "fbx", "osgt"}) {
    const std::string name = std::string("hull.") + extension;
    EXPECT_THAT(refusal_of_mesh(folder.write(name, pointer)), HasSubstr("Git LFS pointer")) << extension;
    EXPECT_THAT(refusal_of_mesh(folder.write(name, "\n<!DOCTYPE HTML><html><body>404</body></html>")),
                HasSubstr("web page"))
        << extension;
  }
  for (const char* const name : {"map.png", "map.jpg", "map.bmp", "map.pgm"}) {
    EXPECT_THAT(refusal_of_picture(folder.write(name, pointer)), HasSubstr("Git LFS pointer")) << name;
    EXPECT_THAT(refusal_of_picture(folder.write(name, "<html><body>404</body></html>")),
                HasSubstr("web page"))
        << name;
  }
  EXPECT_THAT(refusal_of_picture(folder.write("map.png", std::string(400, 'x'))),
              HasSubstr("does not begin like a PNG file"));
  EXPECT_THAT(refusal_of_mesh(folder.write("hull.glb", std::string(400, 'x'))),
              HasSubstr("does not begin like a GLB file"));
}

TEST(FileOfAnotherKind, InUtf16IsNamed) {
  const test::TempFolder folder;
  const std::string ascii =
      "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid x\n";
  std::string wide = "\xFF\xFE";
  for (const char c : ascii) {
    wide += c;
    wide += '\0';
  }
  EXPECT_EQ(refusal_of_mesh(folder.write("hull.stl", ascii)), "");
  EXPECT_THAT(refusal_of_mesh(folder.write("hull.stl", wide)), HasSubstr("UTF-16"));
}

TEST(FileOfAnotherKind, ObjWithTheMarkOfUtf8IsRead) {
  const test::TempFolder folder;
  EXPECT_EQ(refusal_of_mesh(folder.write("hull.obj", "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")),
            "");
}

}  // namespace
}  // namespace sonard::render
