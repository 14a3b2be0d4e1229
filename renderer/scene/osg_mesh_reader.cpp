// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/osg_mesh_reader.hpp"

#include <stdexcept>
#include <utility>

#include <glm/gtc/type_ptr.hpp>
#include <osg/Array>
#include <osg/Geometry>
#include <osg/Material>
#include <osg/NodeVisitor>
#include <osg/Transform>
#include <osg/TriangleIndexFunctor>
#include <osgDB/Callbacks>
#include <osgDB/Registry>

namespace sonard::render {
namespace {

/// Lets osgDB read only the requested file. By itself it follows references, and downloads http textures.
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

/// Elements of an osg array of 2 to 4 floats or doubles, as `Out`; empty if the array is of another kind.
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

/// How a submesh treats the nodes below the node of its name.
enum class Below {
  own,     ///< as in Gazebo, a node with another name is a separate submesh
  subtree  ///< includes all of them
};

class TriangleCollector : public osg::NodeVisitor {
 public:
  TriangleCollector(RawMesh& mesh, const std::string& submesh, Below below)
      : osg::NodeVisitor(TRAVERSE_ACTIVE_CHILDREN), mesh_(mesh), submesh_(submesh), below_(below) {}

  void apply(osg::Node& node) override {
    descend(node, [] {});
  }

  void apply(osg::Transform& transform) override {
    const osg::Matrixd outer = matrix_;
    const int selected = selected_;
    if (below_ == Below::own && !transform.getName().empty()) {
      selected_ = 0;
    }
    descend(transform, [&] { transform.computeLocalToWorldMatrix(matrix_, this); });
    selected_ = selected;
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

  bool is_submesh(const osg::Node& node) const { return !submesh_.empty() && node.getName() == submesh_; }

  /// The name of the material attribute, or else of the state set.
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

  void add(osg::Geometry& geometry) {
    RawPart triangles;
    triangles.material_name = material_of(geometry.getStateSet(), material_);
    triangles.positions = elements<glm::dvec3>(geometry.getVertexArray());
    triangles.normals = elements<glm::vec3>(geometry.getNormalArray());
    triangles.texcoords = elements<glm::vec2>(geometry.getTexCoordArray(0));
    if (triangles.normals.size() != triangles.positions.size()) {
      triangles.normals.clear();
    }
    if (triangles.texcoords.size() != triangles.positions.size()) {
      triangles.texcoords.clear();
    }
    osg::TriangleIndexFunctor<IndexCollector> collector;
    geometry.accept(collector);
    triangles.indices = std::move(collector.indices);
    // osg multiplies its matrices from the left, so its rows are the columns of glm.
    mesh_.add(triangles, glm::make_mat4(matrix_.ptr()));
  }

  RawMesh& mesh_;
  const std::string& submesh_;
  const Below below_;
  osg::Matrixd matrix_;
  std::string material_;
  int selected_ = 0;
};

}  // namespace

RawMesh read_with_osg(const MeshSource& source) {
  osg::ref_ptr<osgDB::Options> options = new osgDB::Options;
  osg::ref_ptr<OneFileOnly> guard = new OneFileOnly(source.file.string());
  osgDB::Registry::instance()->setReadFileCallback(guard);
  options->setReadFileCallback(guard);

  osgDB::ReaderWriter::ReadResult result =
      osgDB::Registry::instance()->readNode(source.file.string(), options);
  osg::ref_ptr<osg::Node> node = result.getNode();
  if (!node) {
    throw std::runtime_error(result.message().empty() ? "the file is damaged or of another format"
                                                      : result.message());
  }
  RawMesh mesh;
  for (const Below below : {Below::own, Below::subtree}) {
    TriangleCollector collector(mesh, source.submesh, below);
    node->accept(collector);
    if (!mesh.parts.empty()) {
      break;
    }
  }
  return mesh;
}

}  // namespace sonard::render
