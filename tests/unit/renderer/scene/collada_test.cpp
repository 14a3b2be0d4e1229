// SPDX-License-Identifier: Apache-2.0
// COLLADA files as Gazebo reads them: the unit is applied, up_axis is not, each named node is a submesh. The
// tests write files by the rules of COLLADA 1.4.1; boxes, areas and volumes are computed by hand.
#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <glm/common.hpp>

#include "renderer/scene/mesh_file.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string source(const std::string& id, int stride, int values, const std::string& numbers) {
  std::string parameters;
  for (int i = 0; i < stride; ++i) {
    parameters += fmt::format("<param name=\"{}\" type=\"float\"/>", stride == 3 ? "XYZ"[i] : "ST"[i]);
  }
  return fmt::format(
      "<source id=\"{0}\"><float_array id=\"{0}-array\" count=\"{1}\">{2}</float_array><technique_common>"
      "<accessor source=\"#{0}-array\" count=\"{3}\" "
      "stride=\"{4}\">{5}</accessor></technique_common></source>\n",
      id, values, numbers, values / stride, stride, parameters);
}

/// A geometry with the corners (0 0 0) (1 0 0) (0 2 0) (0 0 3) and the texture coordinates (0 0) (1 0) (1 1)
/// (0 1). `primitives` may name #ID-v and #ID-uv.
std::string geometry(const std::string& id, const std::string& name, const std::string& primitives) {
  return fmt::format("<geometry id=\"{0}\" name=\"{1}\"><mesh>", id, name) +
         source(id + "-p", 3, 12, "0 0 0 1 0 0 0 2 0 0 0 3") + source(id + "-uv", 2, 8, "0 0 1 0 1 1 0 1") +
         fmt::format(
             "<vertices id=\"{0}-v\"><input semantic=\"POSITION\" source=\"#{0}-p\"/></vertices>\n{1}"
             "</mesh></geometry>\n",
             id, primitives);
}

std::string vertex_input(const std::string& id) {
  return fmt::format("<input semantic=\"VERTEX\" source=\"#{}-v\" offset=\"0\"/>", id);
}

/// The tetrahedron of volume 1, wound outward.
std::string tetrahedron(const std::string& id = "g", const std::string& name = "shape") {
  return geometry(
      id, name, "<triangles count=\"4\">" + vertex_input(id) + "<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>");
}

const std::string instance = "<instance_geometry url=\"#g\"/>";

/// A material called "sand" is bound to its symbol "s".
const std::string with_material =
    "<instance_geometry url=\"#g\"><bind_material><technique_common><instance_material symbol=\"s\" "
    "target=\"#m\"/></technique_common></bind_material></instance_geometry>";

struct Document {
  std::string geometries = tetrahedron();
  std::string nodes = "<node name=\"hull\">" + instance + "</node>";
  std::string asset = "<unit meter=\"1\"/><up_axis>Z_UP</up_axis>";
  std::string scene_id = "scene";
  std::string libraries{};
};

std::string text_of(const Document& document) {
  return "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
         "version=\"1.4.1\"><asset>" +
         document.asset +
         "</asset>\n<library_effects><effect id=\"e\"><profile_COMMON><technique "
         "sid=\"t\"><lambert><diffuse><color>"
         ".8 .8 .8 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>"
         "<library_materials><material id=\"m\" name=\"sand\"><instance_effect url=\"#e\"/></material>"
         "</library_materials>\n" +
         document.libraries + "<library_geometries>" + document.geometries +
         "</library_geometries>\n<library_visual_scenes><visual_scene id=\"" + document.scene_id + "\">" +
         document.nodes + "</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene url=\"#" +
         document.scene_id + "\"/></scene></COLLADA>\n";
}

struct Measures {
  std::size_t triangles = 0;
  double volume_m3 = 0.0;
  double area_m2 = 0.0;
  test::Bounds box{};
};

Measures measures_of(const MeshFile& file) {
  Measures all;
  for (const MeshFilePart& part : file.parts) {
    all.triangles += part.mesh->triangle_count();
    all.volume_m3 += test::volume_m3(*part.mesh);
    all.area_m2 += test::area_m2(*part.mesh);
    const test::Bounds box = test::bounds(*part.mesh);
    all.box.low = glm::min(all.box.low, box.low);
    all.box.high = glm::max(all.box.high, box.high);
  }
  return all;
}

class Collada : public testing::Test {
 protected:
  MeshFile load(const Document& document, const std::string& submesh = "", bool tangents = false) const {
    MeshFileRequest request;
    request.file = folder_.write("mesh.dae", text_of(document));
    request.submesh = submesh;
    request.tangents = tangents;
    return load_mesh_file(request);
  }

  std::string error_of(const Document& document, const std::string& submesh = "") const {
    try {
      load(document, submesh);
    } catch (const WorldError& error) {
      return error.what();
    }
    return "";
  }

  void expect_box(const MeshFile& file, const glm::dvec3& low, const glm::dvec3& high) const {
    const test::Bounds box = measures_of(file).box;
    EXPECT_NEAR(glm::distance(box.low, low), 0.0, 1e-5) << box.low.x << ' ' << box.low.y << ' ' << box.low.z;
    EXPECT_NEAR(glm::distance(box.high, high), 0.0, 1e-5)
        << box.high.x << ' ' << box.high.y << ' ' << box.high.z;
  }

  test::TempFolder folder_;
};

// ---- unit and axes

TEST_F(Collada, TakesTheAxesOfTheFile) {
  Document document;
  const MeshFile upright = load(document);
  expect_box(upright, {0, 0, 0}, {1, 2, 3});
  EXPECT_EQ(upright.up_axis, "");

  document.asset = "<unit meter=\"0.0254\"/><up_axis>Y_UP</up_axis>";
  const MeshFile lying = load(document);
  expect_box(lying, {0, 0, 0}, {0.0254, 0.0508, 0.0762});
  EXPECT_EQ(lying.up_axis, "Y_UP");

  document.asset = "<up_axis>X_UP</up_axis>";
  const MeshFile along_x = load(document);
  expect_box(along_x, {0, 0, 0}, {1, 2, 3});
  EXPECT_EQ(along_x.up_axis, "X_UP");

  document.asset = "<created>2020-01-01T00:00:00Z</created>";
  const MeshFile unsaid = load(document);
  expect_box(unsaid, {0, 0, 0}, {1, 2, 3});
  EXPECT_EQ(unsaid.up_axis, "");
}

TEST_F(Collada, TakesAUnitWithADecimalComma) {
  Document document;
  document.asset = "<unit name=\"centimeter\" meter=\"0,01\"/>";
  expect_box(load(document), {0, 0, 0}, {0.01, 0.02, 0.03});
}

// ---- texture coordinates

/// (0 0 0) (1 0 0) (0 2 0) with the texture coordinates (0 0) (1 0) (0 1): u along x, v along y.
std::string mapped(const std::string& inputs, const std::string& indices) {
  return "<triangles material=\"s\" count=\"1\">" + vertex_input("g") + inputs + "<p>" + indices +
         "</p></triangles>";
}

void expect_map(const MeshFile& file) {
  ASSERT_EQ(file.parts.size(), 1U);
  EXPECT_EQ(file.parts[0].material_name, "sand");
  EXPECT_THAT(file.warnings, IsEmpty());
  const TriangleMesh& mesh = *file.parts[0].mesh;
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(glm::distance(mesh.texcoords[i], glm::vec2(mesh.positions[i].x, mesh.positions[i].y / 2)),
                0.0, 1e-6);
    EXPECT_NEAR(glm::distance(mesh.tangents.at(i), glm::vec4(1, 0, 0, 1)), 0.0, 1e-6);
  }
}

TEST_F(Collada, KeepsTextureCoordinatesIfAMaterialIsBound) {
  const std::string uv = "<input semantic=\"TEXCOORD\" source=\"#g-uv\" offset=\"1\" set=\"0\"/>";
  Document document;
  document.nodes = "<node name=\"plate\">" + with_material + "</node>";
  document.geometries = geometry("g", "", mapped(uv, "0 0 1 1 2 3"));
  expect_map(load(document, "", true));

  document.geometries = geometry("g", "",
                                 "<polylist material=\"s\" count=\"1\">" + vertex_input("g") + uv +
                                     "<vcount>3</vcount><p>0 0 1 1 2 3</p></polylist>");
  expect_map(load(document, "", true));

  // Blender and others number sets from 1; a second set follows.
  document.geometries =
      geometry("g", "",
               mapped("<input semantic=\"TEXCOORD\" source=\"#g-uv\" offset=\"1\" set=\"1\"/>"
                      "<input semantic=\"TEXCOORD\" source=\"#g-p\" offset=\"2\" set=\"2\"/>",
                      "0 0 0 1 1 0 2 3 0"));
  expect_map(load(document, "", true));
}

TEST_F(Collada, LeavesANormalMapOutWhereTextureCoordinatesAreMissing) {
  Document document;
  const MeshFile bare = load(document, "", true);
  EXPECT_EQ(measures_of(bare).triangles, 4U);
  EXPECT_TRUE(bare.parts.at(0).mesh->tangents.empty());
  EXPECT_THAT(bare.warnings, ElementsAre(HasSubstr("mesh.dae: the normal map is left out on")));

  // One of two geometries has them.
  document.geometries =
      tetrahedron() + geometry("h", "",
                               "<triangles count=\"1\">" + vertex_input("h") +
                                   "<input semantic=\"TEXCOORD\" source=\"#h-uv\" offset=\"0\"/>"
                                   "<p>0 1 2</p></triangles>");
  document.nodes =
      "<node name=\"a\">" + instance + "</node><node name=\"b\"><instance_geometry url=\"#h\"/></node>";
  const MeshFile half = load(document, "", true);
  std::vector<std::size_t> with_map;
  for (const MeshFilePart& part : half.parts) {
    if (!part.mesh->tangents.empty()) {
      with_map.push_back(part.mesh->triangle_count());
    }
  }
  EXPECT_THAT(with_map, ElementsAre(1U));
  EXPECT_EQ(measures_of(half).triangles, 5U);
  EXPECT_EQ(half.warnings.size(), 1U);
}

TEST_F(Collada, ReadsTheShapeIfTextureCoordinatesAreDamaged) {
  Document document;
  document.nodes = "<node name=\"plate\">" + with_material + "</node>";
  // There is no texture coordinate 9.
  document.geometries = geometry(
      "g", "",
      mapped("<input semantic=\"TEXCOORD\" source=\"#g-uv\" offset=\"1\" set=\"0\"/>", "0 0 1 9 2 3"));
  const MeshFile file = load(document, "", true);
  EXPECT_EQ(measures_of(file).triangles, 1U);
  EXPECT_NEAR(measures_of(file).area_m2, 1.0, 1e-6);
  EXPECT_THAT(
      file.warnings,
      ElementsAre(HasSubstr("mesh.dae: line 7: <triangles> has the index 9, there are 4 values in #g-uv "
                            "(from 0), which is left out"),
                  HasSubstr("the normal map is left out")));
}

/// A normal for each of the three corners between the two sets of texture coordinates, of which the first is
/// bad.
TEST_F(Collada, KeepsOtherValuesBesideDamagedOnes) {
  const std::string inputs =
      "<input semantic=\"TEXCOORD\" source=\"#g-uv\" offset=\"1\" set=\"0\"/>"
      "<input semantic=\"NORMAL\" source=\"#g-p\" offset=\"2\"/>"
      "<input semantic=\"TEXCOORD\" source=\"#g-uv\" offset=\"3\" set=\"1\"/>";
  Document document;
  document.geometries = geometry("g", "", mapped(inputs, "0 0 1 0 1 -1 2 1 2 0 3 3"));
  const MeshFile file = load(document);
  ASSERT_EQ(file.parts.size(), 1U);
  const TriangleMesh& mesh = *file.parts[0].mesh;
  EXPECT_THAT(mesh.normals, ElementsAre(glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)));
  EXPECT_THAT(mesh.texcoords, ElementsAre(glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)));
}

// ---- ids

// The FBX COLLADA exporter writes such ids.
TEST_F(Collada, LooksAnIdUpAmongElementsOfItsKind) {
  Document document;
  document.scene_id = "Post";
  document.nodes = "<node id=\"Post\" name=\"Post\">" + instance + "</node>";
  EXPECT_EQ(measures_of(load(document)).triangles, 4U);

  document.geometries = tetrahedron("Post");
  document.nodes = "<node id=\"Post\" name=\"Post\"><instance_geometry url=\"#Post\"/></node>";
  EXPECT_EQ(measures_of(load(document)).triangles, 4U);
  EXPECT_EQ(measures_of(load(document, "Post")).triangles, 4U);
}

// ---- submeshes

/// A hull at the origin, a nameless part of it at x = 10, and below it a lid at x = 20 with a handle at x
/// = 25.
Document boat() {
  Document document;
  document.nodes = "<node id=\"hull-id\" name=\"hull\">" + instance +
                   "<node id=\"nameless\"><translate>10 0 0</translate>" + instance +
                   "</node><node id=\"lid-id\" name=\"lid\"><translate>20 0 0</translate>" + instance +
                   "<node name=\"handle\"><translate>5 0 0</translate>" + instance + "</node></node></node>" +
                   "<node name=\"rig\"><node name=\"mast\"><translate>0 30 0</translate>" + instance +
                   "</node><node name=\"boom\"><translate>0 40 0</translate>" + instance + "</node></node>";
  return document;
}

TEST_F(Collada, HasASubmeshForEachNamedNode) {
  expect_box(load(boat()), {0, 0, 0}, {26, 42, 3});
  expect_box(load(boat(), "hull"), {0, 0, 0}, {11, 2, 3});  // with its nameless part, without the lid
  expect_box(load(boat(), "lid"), {20, 0, 0}, {21, 2, 3});
  expect_box(load(boat(), "handle"), {25, 0, 0}, {26, 2, 3});
  expect_box(load(boat(), "mast"), {0, 30, 0}, {1, 32, 3});
}

TEST_F(Collada, FindsASubmeshByOtherNamesToo) {
  expect_box(load(boat(), "lid-id"), {20, 0, 0}, {21, 2, 3});
  expect_box(load(boat(), "nameless"), {10, 0, 0}, {11, 2, 3});
  expect_box(load(boat(), "rig"), {0, 30, 0}, {1, 42, 3});  // has no triangles of its own
  EXPECT_EQ(measures_of(load(boat(), "shape")).triangles, 24U);
  EXPECT_THAT(error_of(boat(), "keel"),
              AllOf(HasSubstr("mesh.dae: no submesh 'keel' with triangles; names in the file: "),
                    HasSubstr("hull"), HasSubstr("lid"), HasSubstr("handle"), HasSubstr("mast")));
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// Gazebo uses the stride and ignores <param>.
TEST_F(Collada, TakesValuesInTheirOrderWhateverTheirNames) {
  Document document = boat();
  const std::string whole = document.geometries;
  const std::string x = "<param name=\"X\" type=\"float\"/>", y = "<param name=\"Y\" type=\"float\"/>",
                    z = "<param name=\"Z\" type=\"float\"/>";
  for (const std::string parameters :
       {"<param type=\"float\"/><param type=\"float\"/><param type=\"float\"/>", "",
        "<param name=\"x\" type=\"float\"/><param name=\"y\" type=\"float\"/><param name=\"z\" "
        "type=\"float\"/>",
        "<param name=\"X\"/>"}) {
    SCOPED_TRACE(parameters);
    document.geometries = with(whole, x + y + z, parameters);
    ASSERT_NE(document.geometries, whole);
    expect_box(load(document, "lid"), {20, 0, 0}, {21, 2, 3});
    EXPECT_THAT(load(document).warnings, IsEmpty());
  }
}

/// Blender writes an empty name for a picture that is embedded in its own file. The others are the forms of
/// COLLADA 1.4 and 1.5.
TEST_F(Collada, IsReadWhateverItsPictures) {
  for (const std::string picture :
       {"<init_from/>", "<init_from></init_from>", "<init_from> </init_from>",
        "<init_from>gone.png</init_from>", "<init_from><ref>gone.png</ref></init_from>", "<data>00</data>",
        "<create_2d/>"}) {
    SCOPED_TRACE(picture);
    Document document = boat();
    document.libraries = "<library_images><image id=\"i\">" + picture + "</image></library_images>";
    expect_box(load(document, "hull"), {0, 0, 0}, {11, 2, 3});
    EXPECT_THAT(load(document).warnings, IsEmpty());
  }
}

TEST_F(Collada, KeepsTheNamesOfMaterialsWhateverTheirEffects) {
  for (const std::string sampler :
       {"<sampler2D><instance_image url=\"#im\"/></sampler2D>",
        "<sampler2D><source>gone</source></sampler2D>", "<sampler2D><instance_image url=\"im\"/></sampler2D>",
        "<sampler2D/>", "<float>x</float>"}) {
    SCOPED_TRACE(sampler);
    Document document;
    document.geometries = geometry(
        "g", "", "<triangles count=\"1\" material=\"s\">" + vertex_input("g") + "<p>0 2 1</p></triangles>");
    document.nodes = "<node name=\"hull\">" + with_material + "</node>";
    std::string text = text_of(document);
    const std::string technique = "<technique sid";
    text.insert(text.find(technique), "<newparam sid=\"p\">" + sampler + "</newparam>");
    text.insert(text.find("<diffuse>"), "<emission><texture texture=\"p\" texcoord=\"c\"/></emission>");
    MeshFileRequest request;
    request.file = folder_.write("mesh.dae", text);
    const MeshFile file = load_mesh_file(request);
    EXPECT_THAT(file.warnings, IsEmpty());
    ASSERT_EQ(file.parts.size(), 1U);
    EXPECT_EQ(file.parts[0].material_name, "sand");
  }
}

TEST_F(Collada, CentresASubmesh) {
  MeshFileRequest request;
  Document document = boat();
  document.asset = "<unit meter=\"0.01\"/>";
  request.file = folder_.write("mesh.dae", text_of(document));
  request.submesh = "lid";
  request.center_submesh = true;
  expect_box(load_mesh_file(request), {-0.005, -0.01, -0.015}, {0.005, 0.01, 0.015});
}

// ---- nodes

TEST_F(Collada, AppliesTransformsOfNodes) {
  Document document;
  document.asset = "<unit meter=\"0.001\"/><up_axis>Y_UP</up_axis>";
  // A quarter turn about z, (x y z) -> (-y x z), after the scale and before the translation.
  document.nodes =
      "<node name=\"a\"><translate>1000 0 0</translate><rotate>0 0 1 90</rotate><scale>1000 1000 "
      "1000</scale>" +
      instance + "</node>";
  expect_box(load(document), {-1, 0, 0}, {1, 1, 3});
  document.nodes =
      "<node name=\"a\"><matrix>0 -1000 0 1000 1000 0 0 0 0 0 1000 0 0 0 0 1</matrix>" + instance + "</node>";
  expect_box(load(document), {-1, 0, 0}, {1, 1, 3});
  EXPECT_NEAR(measures_of(load(document)).volume_m3, 1.0, 1e-5);
}

/// Gazebo composes them as translation, rotation, scale, in any order of the file; a matrix replaces them.
TEST_F(Collada, OrdersTransformsAsGazebo) {
  const auto box_of_node = [&](const std::string& transforms) {
    Document document;
    document.nodes = "<node name=\"hull\">" + transforms + instance + "</node>";
    return load(document);
  };
  expect_box(box_of_node("<scale>2 2 2</scale><translate>10 0 0</translate>"), {10, 0, 0}, {12, 4, 6});
  expect_box(box_of_node("<rotate>0 0 1 90</rotate><translate>10 0 0</translate>"), {8, 0, 0}, {10, 1, 3});
  expect_box(box_of_node("<translate>10 0 0</translate><translate>5 0 0</translate>"), {10, 0, 0},
             {11, 2, 3});
  expect_box(box_of_node("<scale>2 2 2</scale><matrix>1 0 0 7 0 1 0 0 0 0 1 0 0 0 0 1</matrix>"), {7, 0, 0},
             {8, 2, 3});
}

/// By 120 degrees about (1, 1, 1), x becomes y, y becomes z and z becomes x.
TEST_F(Collada, TurnsAboutAnAxisOfAnyLength) {
  for (const auto& [rotation, low, high] :
       {std::tuple<std::string, glm::vec3, glm::vec3>{"1 1 1 120", {0, 0, 0}, {3, 1, 2}},
        {"0 0 2 90", {-2, 0, 0}, {0, 1, 3}},
        {"0 0 -0.5 -90", {-2, 0, 0}, {0, 1, 3}},
        {"0 0 0 90", {0, 0, 0}, {1, 2, 3}}}) {
    Document document;
    document.nodes = "<node name=\"a\"><rotate>" + rotation + "</rotate>" + instance + "</node>";
    expect_box(load(document), low, high);
  }
}

TEST_F(Collada, KeepsTheOutsideOfAMirroredNodeOutside) {
  Document document;
  document.nodes = "<node name=\"a\"><scale>-1 1 1</scale>" + instance +
                   "<node name=\"b\"><scale>1 -2 1</scale>" + instance + "</node></node>";
  const MeshFile file = load(document);
  expect_box(file, {-1, -4, 0}, {0, 2, 3});
  EXPECT_NEAR(measures_of(file).volume_m3, 1.0 + 2.0, 1e-5);
}

TEST_F(Collada, PutsAGeometryWhereverItIsInstanced) {
  Document document;
  document.libraries = "<library_nodes><node id=\"pile\" name=\"pile\"><translate>0 0 5</translate>" +
                       instance + "</node></library_nodes>";
  document.nodes =
      "<node name=\"west\"><translate>-10 0 0</translate><instance_node url=\"#pile\"/></node>"
      "<node name=\"east\"><translate>10 0 0</translate><instance_node url=\"#pile\"/></node>"
      "<node name=\"twice\">" +
      instance + instance + "</node>";
  const MeshFile file = load(document);
  EXPECT_EQ(measures_of(file).triangles, 16U);
  expect_box(file, {-10, 0, 0}, {11, 2, 8});
}

// ---- primitives

TEST_F(Collada, ReadsPolygonsStripsAndFans) {
  struct Case {
    std::string primitives;
    std::size_t triangles;
    double area_m2;
  };
  // The faces in z = 0, y = 0 and x = 0 have areas of 1, 1.5 and 3.
  const std::string v = vertex_input("g");
  for (const Case& given : {
           Case{"<polygons count=\"2\">" + v + "<p>0 2 1</p><p>0 1 3</p></polygons>", 2, 2.5},
           Case{"<polylist count=\"2\">" + v + "<vcount>3 3</vcount><p>0 2 1 0 1 3</p></polylist>", 2, 2.5},
           Case{"<triangles count=\"1\">" + v + "<p>0 2 1</p></triangles><triangles count=\"1\">" + v +
                    "<p>0 1 3</p></triangles>",
                2, 2.5},
           Case{"<tristrips count=\"1\">" + v + "<p>2 0 1 3</p></tristrips>", 2, 2.5},
           Case{"<tristrips count=\"2\">" + v + "<p>0 2 1</p><p>0 1 3</p></tristrips>", 2, 2.5},
           Case{"<trifans count=\"1\">" + v + "<p>0 2 1 3</p></trifans>", 2, 2.5},
           Case{"<lines count=\"1\">" + v + "<p>0 1</p></lines><triangles count=\"1\">" + v +
                    "<p>0 3 2</p></triangles>",
                1, 3.0},
           Case{"<triangles count=\"0\">" + v + "</triangles><triangles count=\"1\">" + v +
                    "<p>0 3 2</p></triangles>",
                1, 3.0},
       }) {
    Document document;
    document.geometries = geometry("g", "", given.primitives);
    const Measures measured = measures_of(load(document));
    EXPECT_EQ(measured.triangles, given.triangles) << given.primitives;
    EXPECT_NEAR(measured.area_m2, given.area_m2, 1e-6) << given.primitives;
  }
}

TEST_F(Collada, RefusesAFileWithoutTriangles) {
  Document document;
  document.nodes = "<node name=\"eye\"/>";
  EXPECT_THAT(error_of(document), HasSubstr("mesh.dae: the mesh has no triangles"));
  document.geometries = geometry("g", "", "<lines count=\"1\">" + vertex_input("g") + "<p>0 1</p></lines>");
  document.nodes = "<node name=\"wire\">" + instance + "</node>";
  EXPECT_THAT(error_of(document), HasSubstr("mesh.dae: "));
}

TEST_F(Collada, NamesAnIndexWithoutAVertex) {
  const std::string v = vertex_input("g");
  for (const auto& [primitives, name, index] : std::vector<std::tuple<std::string, std::string, int>>{
           {"<triangles count=\"1\">" + v + "<p>0 2 4</p></triangles>", "triangles", 4},
           {"<triangles count=\"1\">" + v + "<p>0 2 -1</p></triangles>", "triangles", -1},
           {mapped("<input semantic=\"TEXCOORD\" source=\"#g-uv\" offset=\"1\"/>", "0 0 99 1 2 3"),
            "triangles", 99},
           {"<polylist count=\"1\">" + v + "<vcount>4</vcount><p>0 1 2 7</p></polylist>", "polylist", 7},
           {"<polygons count=\"2\">" + v + "<p>0 2 1</p><p>0 1 4</p></polygons>", "polygons", 4},
           {"<polygons count=\"1\">" + v + "<ph><p>0 5 1</p><h>0 1 2</h></ph></polygons>", "polygons", 5},
           {"<polygons count=\"1\">" + v + "<ph><p>0 2 1</p><h>0 1 6</h></ph></polygons>", "polygons", 6},
           {"<tristrips count=\"1\">" + v + "<p>2 0 1 8</p></tristrips>", "tristrips", 8},
           {"<trifans count=\"1\">" + v + "<p>0 2 1 9</p></trifans>", "trifans", 9}}) {
    Document document;
    document.geometries = geometry("g", "", primitives);
    EXPECT_THAT(error_of(document), AllOf(HasSubstr("mesh.dae: "),
                                          HasSubstr(fmt::format("line 7: <{}> has the index {}, there are 4 "
                                                                "vertices (from 0)",
                                                                name, index))));
  }
}

TEST_F(Collada, NamesAWordThatIsNoIndex) {
  for (const std::string word : {"x", "1e0", "2.0", "99999999999999999999"}) {
    Document document;
    document.geometries = geometry(
        "g", "", "<triangles count=\"1\">" + vertex_input("g") + "<p>0 2 " + word + "</p></triangles>");
    EXPECT_THAT(error_of(document),
                HasSubstr("mesh.dae: line 7: <p> has '" + word + "' (expected whole numbers)"));
  }
}

TEST_F(Collada, DropsTrianglesThatAreNotMadeOfNumbers) {
  for (const std::string word : {"NaN", "1.#QNAN", "-1.#IND00", "INF", "x"}) {
    Document document;
    document.geometries = with(tetrahedron(), "0 2 0 0 0 3<", "0 2 0 0 0 " + word + "<");
    const MeshFile file = load(document);
    EXPECT_EQ(measures_of(file).triangles, 1U) << word;
    EXPECT_EQ(file.diagnostics.non_finite_triangles, 3U) << word;
    expect_box(file, {0, 0, 0}, {1, 2, 0});
  }
}

TEST_F(Collada, RefusesAFileThatIsCutShort) {
  MeshFileRequest request;
  request.file = folder_.write("cut.dae", text_of(Document()).substr(0, 900));
  try {
    load_mesh_file(request);
    FAIL() << "a file that is cut short was read";
  } catch (const WorldError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cut.dae: the file is cut short: it does not end with </COLLADA>"));
  }
}

// ---- encodings, skins, animations

TEST_F(Collada, IsReadFromUtf16) {
  const std::u16string units = u"name=\"Lukendeckel \u00FC\U0001F6A2\"";
  for (const bool is_little_endian : {true, false}) {
    std::string bytes;
    const auto put = [&](char16_t unit) {
      const std::array<char, 2> pair{static_cast<char>(unit & 255U), static_cast<char>(unit >> 8U)};
      bytes += pair[is_little_endian ? 0 : 1];
      bytes += pair[is_little_endian ? 1 : 0];
    };
    put(0xFEFF);
    const std::string text = text_of(boat());
    const std::size_t name = text.find("name=\"lid\"");
    std::ranges::for_each(text.substr(0, name), put);
    std::ranges::for_each(units, put);
    std::ranges::for_each(text.substr(name + std::string("name=\"lid\"").size()), put);
    MeshFileRequest request;
    request.file = folder_.write("wide.dae", bytes);
    request.submesh = "Lukendeckel \xC3\xBC\xF0\x9F\x9A\xA2";
    expect_box(load_mesh_file(request), {20, 0, 0}, {21, 2, 3});
  }
}

/// Assimp reads skins, and crashes on some. The pose that is stored needs neither skins nor animations.
TEST_F(Collada, HasTheMeshOfASkin) {
  Document document;
  document.libraries =
      "<library_animations><animation id=\"a\"><channel source=\"#gone\"/></animation></library_animations>"
      "<library_controllers><controller id=\"skin\"><skin source=\"#morph\"><bind_shape_matrix>1 0 0 7 0 1 0 "
      "0 0 "
      "0 1 0 0 0 0 1</bind_shape_matrix><vertex_weights count=\"1\"/></skin></controller><controller "
      "id=\"morph\"><morph source=\"#g\"/></controller></library_controllers>";
  document.nodes = "<node name=\"hull\"><translate>5 0 0</translate>" +
                   with(with(with_material, "instance_geometry", "instance_controller"), "#g", "#skin") +
                   "</node>";
  const MeshFile file = load(document, "hull");
  expect_box(file, {5, 0, 0}, {6, 2, 3});
  EXPECT_EQ(measures_of(file).triangles, 4U);
}

}  // namespace
}  // namespace sonard::render
