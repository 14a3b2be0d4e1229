// SPDX-License-Identifier: Apache-2.0
// Mesh files that Assimp reads, written here byte by byte by the formats' own rules (glTF 2.0
// specification 2.0.1, sections 3 and 4; ASCII FBX 7.3): the tetrahedron (0 0 0) (1 0 0) (0 2 0) (0 0 3) of
// volume 1.
#include <sys/stat.h>

#include <chrono>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/mesh_file.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::HasSubstr;

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// Positions, then indices. The formats are little endian, and so are the machines that run sonard.
std::string buffer() {
  return bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3}) +
         bytes_of<std::uint16_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
}

/// @param buffer_uri `"uri": "NAME", ` or nothing, as in a GLB.
std::string json(const std::string& buffer_uri, const std::string& node = R"("name": "hull", "mesh": 0)") {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{)" + node +
         R"(}],
 "materials": [{"name": "concrete"}],
 "meshes": [{"name": "shell", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
 "buffers": [{)" +
         buffer_uri + R"("byteLength": 72}],
 "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 3]},
               {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]})";
}

std::string glb(std::string text) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::string binary = buffer();
  const auto size = [](std::size_t bytes) { return static_cast<std::uint32_t>(bytes); };
  return "glTF" + bytes_of<std::uint32_t>({2, size(28 + text.size() + binary.size()), size(text.size())}) +
         "JSON" + text + bytes_of<std::uint32_t>({size(binary.size())}) + std::string("BIN\0", 4) + binary;
}

/// In units of `unit_cm` centimetres with y up, the default of the format: x to the right, z to the front.
std::string fbx(double unit_cm) {
  return fmt::format(R"(; FBX 7.3.0 project file
FBXHeaderExtension:  {{
	FBXHeaderVersion: 1003
	FBXVersion: 7300
}}
GlobalSettings:  {{
	Version: 1000
	Properties70:  {{
		P: "UpAxis", "int", "Integer", "",1
		P: "UpAxisSign", "int", "Integer", "",1
		P: "FrontAxis", "int", "Integer", "",2
		P: "FrontAxisSign", "int", "Integer", "",1
		P: "CoordAxis", "int", "Integer", "",0
		P: "CoordAxisSign", "int", "Integer", "",1
		P: "UnitScaleFactor", "double", "Number", "",{0}
	}}
}}
Objects:  {{
	Geometry: 100, "Geometry::shell", "Mesh" {{
		Vertices: *12 {{
			a: 0,0,0,{1},0,0,0,0,{2},0,{3},0
		}}
		PolygonVertexIndex: *12 {{
			a: 0,2,-2,0,1,-4,0,3,-3,1,2,-4
		}}
		GeometryVersion: 124
		LayerElementMaterial: 0 {{
			Version: 101
			Name: ""
			MappingInformationType: "AllSame"
			ReferenceInformationType: "IndexToDirect"
			Materials: *1 {{
				a: 0
			}}
		}}
		Layer: 0 {{
			Version: 100
			LayerElement:  {{
				Type: "LayerElementMaterial"
				TypedIndex: 0
			}}
		}}
	}}
	Model: 200, "Model::hull", "Mesh" {{
		Version: 232
	}}
	Material: 300, "Material::concrete", "" {{
		Version: 102
		ShadingModel: "phong"
	}}
}}
Connections:  {{
	C: "OO",200,0
	C: "OO",100,200
	C: "OO",300,200
}}
)",
                     unit_cm, 100 / unit_cm, -200 / unit_cm, 300 / unit_cm);
}

MeshFile load(const std::filesystem::path& file, const std::string& submesh = "") {
  MeshFileRequest request;
  request.file = file;
  request.submesh = submesh;
  return load_mesh_file(request);
}

std::string error_of(const std::filesystem::path& file, const std::string& submesh = "") {
  try {
    load(file, submesh);
  } catch (const WorldError& error) {
    return error.what();
  }
  return "";
}

void expect_tetrahedron(const MeshFile& file, const glm::dvec3& at_m = glm::dvec3(0.0)) {
  ASSERT_EQ(file.parts.size(), 1U);
  const TriangleMesh& mesh = *file.parts[0].mesh;
  EXPECT_EQ(file.parts[0].material_name, "concrete");
  EXPECT_EQ(mesh.triangle_count(), 4U);
  EXPECT_NEAR(test::volume_m3(mesh), 1.0, 1e-5);  // wound outward: not -1
  const test::Bounds box = test::bounds(mesh);
  EXPECT_LT(glm::length(box.low - at_m), 1e-5);
  EXPECT_LT(glm::length(box.high - at_m - glm::dvec3(1.0, 2.0, 3.0)), 1e-5);
}

class GltfAndFbx : public testing::Test {
 protected:
  test::TempFolder folder_;
};

TEST_F(GltfAndFbx, ReadsAGltfWithItsBufferBesideIt) {
  folder_.write("parts/hull.bin", buffer());
  expect_tetrahedron(load(folder_.write("hull.gltf", json(R"("uri": "parts/hull.bin", )"))));
}

TEST_F(GltfAndFbx, ReadsAGlb) {
  expect_tetrahedron(load(folder_.write("hull.glb", glb(json("")))));
}

TEST_F(GltfAndFbx, AppliesTransformsOfNodes) {
  const std::string node = R"("name": "hull", "mesh": 0, "translation": [10, 20, 30])";
  expect_tetrahedron(load(folder_.write("moved.glb", glb(json("", node)))), {10, 20, 30});
}

TEST_F(GltfAndFbx, KeepsTheOutsideOfAMirroredNodeOutside) {
  const std::string node = R"("name": "hull", "mesh": 0, "scale": [-1, 1, 1])";
  expect_tetrahedron(load(folder_.write("mirrored.glb", glb(json("", node)))), {-1, 0, 0});
}

TEST_F(GltfAndFbx, FindsASubmeshByTheNameOfItsNodeOrMesh) {
  const std::filesystem::path file = folder_.write("hull.glb", glb(json("")));
  expect_tetrahedron(load(file, "hull"));
  expect_tetrahedron(load(file, "shell"));
  EXPECT_THAT(error_of(file, "mast"),
              HasSubstr("no submesh 'mast' with triangles; names in the file: hull, shell"));
}

TEST_F(GltfAndFbx, TakesUnitAndAxesOfAnFbx) {
  expect_tetrahedron(load(folder_.write("centimetres.fbx", fbx(1.0))));
  expect_tetrahedron(load(folder_.write("metres.fbx", fbx(100.0))));
  expect_tetrahedron(load(folder_.write("millimetres.fbx", fbx(0.1)), "hull"));
}

// glTF 2.0, 2.8: names of files are URIs, so blanks are escaped.
TEST_F(GltfAndFbx, ReadsABufferWithAnEscapedName) {
  folder_.write("my hull/hull #1 50%.bin", buffer());
  for (const char* uri : {"my%20hull/hull%20%231%2050%25.bin", "my hull/hull #1 50%.bin"}) {
    SCOPED_TRACE(uri);
    expect_tetrahedron(load(folder_.write("a%20b/../hull.gltf", json(fmt::format(R"("uri": "{}", )", uri)))));
  }
  folder_.write("a%20b/raw%20name.bin", buffer());
  expect_tetrahedron(load(folder_.write("a%20b/hull.gltf", json(R"("uri": "raw%20name.bin", )"))));
  folder_.write("a%20b/raw name.bin", buffer());
  expect_tetrahedron(load(folder_.write("a%20b/hull.gltf", json(R"("uri": "raw%20name.bin", )"))));
}

TEST_F(GltfAndFbx, NamesOnlyFilesOfItsWorld) {
  const test::TempFolder elsewhere;
  const std::string far = elsewhere.write("secret.bin", buffer()).string();
  folder_.write("buffers/hull.bin", buffer());
  std::filesystem::create_symlink(far, folder_.path() / "link.bin");
  MeshFileRequest request;
  const auto read = [&](const std::string& uri) {
    request.file = folder_.write("meshes/hull.gltf", json(fmt::format(R"("uri": "{}", )", uri)));
    try {
      load_mesh_file(request);
    } catch (const WorldError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(read("/etc/passwd"), HasSubstr("hull.gltf: it refers to /etc/passwd, outside of the folders"));
  const std::string up = elsewhere.path().filename().string() + "/secret.bin";
  for (const std::string& uri :
       {far, "../../" + up, "..%2F..%2F" + up, "%2e%2e/../" + up, std::string("../link.bin")}) {
    EXPECT_THAT(read(uri), HasSubstr("it refers to " + far)) << uri;
  }
  EXPECT_THAT(read("../buffers/hull.bin"), HasSubstr("it refers to"));
  request.folders = {folder_.path()};
  EXPECT_EQ(read("../buffers/hull.bin"), "");
  EXPECT_THAT(read("/home/somebody/else/hull.bin"), HasSubstr("could not open referenced file"));
}

TEST_F(GltfAndFbx, NamesOnlyRegularFiles) {
  ASSERT_EQ(::mkfifo((folder_.path() / "hull.bin").c_str(), 0600), 0);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(error_of(folder_.write("hull.gltf", json(R"("uri": "hull.bin", )"))),
              HasSubstr("hull.bin, which is not a regular file"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST_F(GltfAndFbx, SaysWhatIsWrongWithADamagedFile) {
  const std::string whole = glb(json(""));
  for (std::size_t bytes = 0; bytes < whole.size(); bytes += 7) {
    EXPECT_THAT(error_of(folder_.write("cut.glb", whole.substr(0, bytes))), HasSubstr("cut.glb: ")) << bytes;
  }
  EXPECT_THAT(error_of(folder_.write("empty.fbx", "")), HasSubstr("empty.fbx: "));
}

}  // namespace
}  // namespace sonard::render
