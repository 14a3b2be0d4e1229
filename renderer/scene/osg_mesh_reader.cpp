// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/osg_mesh_reader.hpp"

#include <algorithm>
#include <stdexcept>

#include <osg/Array>
#include <osg/Geometry>
#include <osg/Material>
#include <osg/NodeVisitor>
#include <osg/Transform>
#include <osg/TriangleIndexFunctor>
#include <osgDB/Callbacks>
#include <osgDB/Registry>

#include "renderer/scene/blob.hpp"

namespace sonard::render {
namespace {

/// Lets osgDB read the one file that was asked for. Plugins follow references of their own accord: an OBJ
/// material with an http texture makes osgDB fetch it.
class OneFileOnly : public osgDB::ReadFileCallback {
  using Result = osgDB::ReaderWriter::ReadResult;

 public:
  explicit OneFileOnly(std::string file) : file_(std::move(file)) {}

  Result readNode(const std::string& name, const osgDB::Options* options) override {
    return name == file_ ? osgDB::ReadFileCallback::readNode(name, options) : refused();
  }
  Result openArchive(const std::string&, osgDB::ReaderWriter::ArchiveStatus, unsigned int,
                     const osgDB::Options*) override {
    return refused();
  }
  Result readObject(const std::string&, const osgDB::Options*) override { return refused(); }
  Result readImage(const std::string&, const osgDB::Options*) override { return refused(); }
  Result readHeightField(const std::string&, const osgDB::Options*) override { return refused(); }
  Result readShader(const std::string&, const osgDB::Options*) override { return refused(); }
  Result readScript(const std::string&, const osgDB::Options*) override { return refused(); }

 private:
  static Result refused() { return {Result::FILE_NOT_FOUND}; }

  std::string file_;
};

struct IndexCollector {
  std::vector<std::uint32_t> indices;
  void operator()(unsigned int a, unsigned int b, unsigned int c) {
    indices.insert(indices.end(), {a, b, c});
  }
};

/// Elements of an osg array of 2 to 4 floats or doubles, as `Out`; empty when the array is of another kind.
template <typename Out, typename OsgArray>
std::vector<Out> convert(const OsgArray& array) {
  std::vector<Out> values;
  values.reserve(array.size());
  for (const auto& element : array) {
    Out value;
    for (int i = 0; i < Out::length(); ++i) {
      value[i] = static_cast<typename Out::value_type>(element[static_cast<unsigned int>(i)]);
    }
    values.push_back(value);
  }
  return values;
}

template <typename Out>
std::vector<Out> elements(const osg::Array* array) {
  if (const auto* float3 = dynamic_cast<const osg::Vec3Array*>(array)) {
    return convert<Out>(*float3);
  }
  if (const auto* double3 = dynamic_cast<const osg::Vec3dArray*>(array)) {
    return convert<Out>(*double3);
  }
  if constexpr (Out::length() == 2) {
    if (const auto* float2 = dynamic_cast<const osg::Vec2Array*>(array)) {
      return convert<Out>(*float2);
    }
    if (const auto* double2 = dynamic_cast<const osg::Vec2dArray*>(array)) {
      return convert<Out>(*double2);
    }
  }
  return {};
}

class TriangleCollector : public osg::NodeVisitor {
 public:
  TriangleCollector(RawMesh& mesh, const std::string& submesh)
      : osg::NodeVisitor(TRAVERSE_ACTIVE_CHILDREN), mesh_(mesh), submesh_(submesh) {}

  void apply(osg::Node& node) override {
    descend(node, [] {});
  }

  void apply(osg::Transform& transform) override {
    const osg::Matrixd outer = matrix_;
    descend(transform, [&] { transform.computeLocalToWorldMatrix(matrix_, this); });
    matrix_ = outer;
  }

  void apply(osg::Geometry& geometry) override {
    descend(geometry, [] {});
    if (submesh_.empty() || selected_ > 0 || is_submesh(geometry)) {
      add(geometry);
    }
  }

 private:
  template <typename Enter>
  void descend(osg::Node& node, Enter&& enter) {
    if (!node.getName().empty()) {
      mesh_.names.push_back(node.getName());
    }
    const std::string outer_material = material_;
    material_ = material_of(node.getStateSet(), material_);
    const bool selects = is_submesh(node);
    selected_ += selects ? 1 : 0;
    enter();
    traverse(node);
    selected_ -= selects ? 1 : 0;
    material_ = outer_material;
  }

  /// The OBJ plugin names a node "group:object".
  bool is_submesh(const osg::Node& node) const {
    if (submesh_.empty()) {
      return false;
    }
    const std::string& name = node.getName();
    const std::size_t colon = name.find(':');
    return name == submesh_ || (colon != std::string::npos &&
                                (name.substr(0, colon) == submesh_ || name.substr(colon + 1) == submesh_));
  }

  /// OBJ puts the name on the material attribute, DAE on the state set.
  static std::string material_of(const osg::StateSet* state, const std::string& inherited) {
    if (state == nullptr) {
      return inherited;
    }
    const auto* material =
        dynamic_cast<const osg::Material*>(state->getAttribute(osg::StateAttribute::MATERIAL));
    if (material != nullptr && !material->getName().empty()) {
      return material->getName();
    }
    return state->getName().empty() ? inherited : state->getName();
  }

  RawPart& part_for(const std::string& material, bool normals, bool texcoords) {
    for (RawPart& part : mesh_.parts) {
      if (part.material_name == material && part.normals.empty() != normals &&
          part.texcoords.empty() != texcoords) {
        return part;
      }
    }
    mesh_.parts.emplace_back().material_name = material;
    return mesh_.parts.back();
  }

  void add(osg::Geometry& geometry) {
    const std::vector<glm::dvec3> positions = elements<glm::dvec3>(geometry.getVertexArray());
    std::vector<glm::vec3> normals = elements<glm::vec3>(geometry.getNormalArray());
    std::vector<glm::vec2> texcoords = elements<glm::vec2>(geometry.getTexCoordArray(0));
    if (normals.size() != positions.size()) {
      normals.clear();
    }
    if (texcoords.size() != positions.size()) {
      texcoords.clear();
    }
    osg::TriangleIndexFunctor<IndexCollector> triangles;
    geometry.accept(triangles);
    if (positions.empty() || triangles.indices.empty()) {
      return;
    }
    RawPart& part =
        part_for(material_of(geometry.getStateSet(), material_), !normals.empty(), !texcoords.empty());
    append(part, positions, normals, texcoords, triangles.indices);
  }

  void append(RawPart& part, const std::vector<glm::dvec3>& positions, const std::vector<glm::vec3>& normals,
              const std::vector<glm::vec2>& texcoords, const std::vector<std::uint32_t>& indices) const {
    const auto base = static_cast<std::uint32_t>(part.positions.size());
    for (const glm::dvec3& p : positions) {
      const osg::Vec3d moved = osg::Vec3d(p.x, p.y, p.z) * matrix_;
      part.positions.emplace_back(moved.x(), moved.y(), moved.z());
    }
    const osg::Matrixd inverse = osg::Matrixd::inverse(matrix_);
    for (const glm::vec3& n : normals) {
      const osg::Vec3d turned = osg::Matrixd::transform3x3(
          inverse, osg::Vec3d(static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)));
      part.normals.emplace_back(turned.x(), turned.y(), turned.z());
    }
    part.texcoords.insert(part.texcoords.end(), texcoords.begin(), texcoords.end());
    const bool mirrored = determinant(matrix_) < 0.0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      part.indices.insert(part.indices.end(), {base + indices[i], base + indices[mirrored ? i + 2 : i + 1],
                                               base + indices[mirrored ? i + 1 : i + 2]});
    }
  }

  static double determinant(const osg::Matrixd& m) {
    const osg::Vec3d a(m(0, 0), m(0, 1), m(0, 2));
    const osg::Vec3d b(m(1, 0), m(1, 1), m(1, 2));
    const osg::Vec3d c(m(2, 0), m(2, 1), m(2, 2));
    return (a ^ b) * c;
  }

  RawMesh& mesh_;
  const std::string& submesh_;
  osg::Matrixd matrix_;
  std::string material_;
  int selected_ = 0;
};

}  // namespace

RawMesh read_with_osg(const std::filesystem::path& file, const std::string& submesh) {
  osg::ref_ptr<osgDB::Options> options = new osgDB::Options;
  // Without these the OBJ plugin turns the model to its own idea of "up" and smooths edges that have no
  // normals, and the STL plugin spends minutes on making triangle strips.
  options->setOptionString("noRotation noTriStripPolygons generateFacetNormals");
  options->setPrecisionHint(osgDB::Options::DOUBLE_PRECISION_VERTEX);
  osg::ref_ptr<OneFileOnly> guard = new OneFileOnly(file.string());
  osgDB::Registry::instance()->setReadFileCallback(guard);
  options->setReadFileCallback(guard);

  osgDB::ReaderWriter::ReadResult result = osgDB::Registry::instance()->readNode(file.string(), options);
  osg::ref_ptr<osg::Node> node = result.getNode();
  if (!node) {
    throw std::runtime_error(result.message().empty() ? "the file is damaged or of another format"
                                                      : result.message());
  }
  RawMesh mesh;
  TriangleCollector collector(mesh, submesh);
  node->accept(collector);
  return mesh;
}

std::string to_bytes(const RawMesh& mesh) {
  BlobWriter writer;
  writer.put(static_cast<std::uint64_t>(mesh.parts.size()));
  for (const RawPart& part : mesh.parts) {
    writer.put(part.material_name);
    writer.put(part.positions);
    writer.put(part.normals);
    writer.put(part.texcoords);
    writer.put(part.indices);
  }
  writer.put(static_cast<std::uint64_t>(mesh.names.size()));
  for (const std::string& name : mesh.names) {
    writer.put(name);
  }
  return writer.take();
}

RawMesh raw_mesh_of(const std::string& bytes) {
  BlobReader reader(bytes);
  RawMesh mesh;
  const std::uint64_t parts = reader.get_number();
  for (std::uint64_t i = 0; i < parts; ++i) {
    RawPart& part = mesh.parts.emplace_back();
    part.material_name = reader.get_string();
    part.positions = reader.get_vector<glm::dvec3>();
    part.normals = reader.get_vector<glm::vec3>();
    part.texcoords = reader.get_vector<glm::vec2>();
    part.indices = reader.get_vector<std::uint32_t>();
  }
  const std::uint64_t names = reader.get_number();
  for (std::uint64_t i = 0; i < names; ++i) {
    mesh.names.push_back(reader.get_string());
  }
  return mesh;
}

}  // namespace sonard::render
