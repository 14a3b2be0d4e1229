// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <ignition/math/Pose3.hh>
#include <sdf/Box.hh>
#include <sdf/Capsule.hh>
#include <sdf/Collision.hh>
#include <sdf/Cylinder.hh>
#include <sdf/Ellipsoid.hh>
#include <sdf/Geometry.hh>
#include <sdf/Heightmap.hh>
#include <sdf/Link.hh>
#include <sdf/Material.hh>
#include <sdf/Mesh.hh>
#include <sdf/Model.hh>
#include <sdf/Pbr.hh>
#include <sdf/Plane.hh>
#include <sdf/Root.hh>
#include <sdf/SemanticPose.hh>
#include <sdf/Sensor.hh>
#include <sdf/Sphere.hh>
#include <sdf/Visual.hh>
#include <sdf/World.hh>

#include "renderer/scene/image_file.hpp"
#include "renderer/scene/left_out.hpp"
#include "renderer/scene/materials.hpp"
#include "renderer/scene/mesh.hpp"
#include "renderer/scene/mesh_file.hpp"
#include "renderer/scene/primitives.hpp"
#include "renderer/scene/sdf_material.hpp"
#include "renderer/scene/sdf_parser.hpp"
#include "renderer/scene/terrain.hpp"
#include "renderer/scene/uri_resolver.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {
namespace {

namespace fs = std::filesystem;

glm::dvec3 vec(const ignition::math::Vector3d& v) {
  return {v.X(), v.Y(), v.Z()};
}

Pose pose_of(const ignition::math::Pose3d& pose) {
  return {vec(pose.Pos()),
          glm::normalize(glm::dquat(pose.Rot().W(), pose.Rot().X(), pose.Rot().Y(), pose.Rot().Z()))};
}

/// A visual, or a collision that stands in for one.
struct Shape {
  std::string path;  ///< "model::link::visual"
  sdf::ElementPtr element;
  const sdf::Geometry* geometry = nullptr;
  const sdf::Material* material = nullptr;
  std::optional<double> laser_retro;
  Pose T_body_shape;
};

bool has_visual(const sdf::Model& model) {
  for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
    if (model.LinkByIndex(i)->VisualCount() > 0) {
      return true;
    }
  }
  for (std::uint64_t i = 0; i < model.ModelCount(); ++i) {
    if (has_visual(*model.ModelByIndex(i))) {
      return true;
    }
  }
  return false;
}

class WorldBuilder {
 public:
  WorldBuilder(const fs::path& file, const std::vector<fs::path>& model_folders)
      : file_(file), resolver_(file, model_folders) {}

  World build() {
    const sdf::Root root = parse_sdf(file_, resolver_, world_.warnings);
    check_own_elements(root.Element());
    if (const sdf::World* world = root.WorldByIndex(0)) {
      world_.name = world->Name();
      world_.water_surface_z_m = water_surface_z_m(world->Element());
      for (std::uint64_t i = 0; i < world->ModelCount(); ++i) {
        add_body(*world->ModelByIndex(i));
      }
    } else {
      world_.name = root.Model()->Name();
      add_body(*root.Model());
    }
    if (world_.triangle_count() == 0) {
      throw WorldError(fmt::format("{}: the world has no triangles: nothing would echo", file_.string()));
    }
    drop_repeated_warnings();
    tell_what_is_left_out(root.Element());
    return std::move(world_);
  }

 private:
  /// A material that a model hands down is looked at once per visual.
  void drop_repeated_warnings() {
    std::set<std::string> seen;
    std::erase_if(world_.warnings, [&](const std::string& line) { return !seen.insert(line).second; });
  }

  void tell_what_is_left_out(const sdf::ElementPtr& root) {
    left_out_.add_elements_of(root);
    world_.left_out = left_out_.silent();
    for (const std::string& line : left_out_.audible()) {
      world_.warnings.push_back(fmt::format("{}: left out: {}", file_.string(), line));
    }
  }

  [[noreturn]] static void fail(const sdf::ElementPtr& element, const std::string& path,
                                const std::string& message) {
    throw WorldError(fmt::format("{}: {}: {}", place_of(element), path, message));
  }

  /// Pose in the parent frame, or in the frame named by `relative_to`.
  static Pose resolve(const sdf::SemanticPose& semantic, const std::string& relative_to,
                      const sdf::ElementPtr& element, const std::string& path) {
    ignition::math::Pose3d pose;
    const sdf::Errors errors = semantic.Resolve(pose, relative_to);
    if (!errors.empty()) {
      fail(element, path, errors.front().Message());
    }
    return pose_of(pose);
  }

  void add_body(const sdf::Model& model) {
    if (world_.find_body(model.Name()) != nullptr) {
      fail(model.Element(), model.Name(), "another model has this name");
    }
    Body body{model.Name(), resolve(model.SemanticPose(), "", model.Element(), model.Name()), {}};
    const bool visible = has_visual(model);
    if (!visible) {
      world_.warnings.push_back(fmt::format("{}: {}: the model has no visual: its collision shapes are used",
                                            place_of(model.Element()), model.Name()));
    }
    add_model(body, model, Pose{}, model.Name(), visible);
    world_.bodies.push_back(std::move(body));
  }

  void add_model(Body& body, const sdf::Model& model, const Pose& T_body_model, const std::string& path,
                 bool visible) {
    for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
      const sdf::Link& link = *model.LinkByIndex(i);
      const std::string link_path = path + "::" + link.Name();
      if (visible) {
        add_visuals(body, link, T_body_model, link_path);
      } else {
        add_collisions(body, link, T_body_model, link_path);
      }
      add_sonars(body, link, T_body_model, link_path);
    }
    for (std::uint64_t i = 0; i < model.ModelCount(); ++i) {
      const sdf::Model& nested = *model.ModelByIndex(i);
      const std::string nested_path = path + "::" + nested.Name();
      const Pose T_model_nested = resolve(nested.SemanticPose(), "", nested.Element(), nested_path);
      add_model(body, nested, T_body_model * T_model_nested, nested_path, visible);
    }
  }

  void add_visuals(Body& body, const sdf::Link& link, const Pose& T_body_model,
                   const std::string& link_path) {
    for (std::uint64_t i = 0; i < link.VisualCount(); ++i) {
      const sdf::Visual& visual = *link.VisualByIndex(i);
      Shape shape{
          link_path + "::" + visual.Name(), visual.Element(), visual.Geom(), visual.Material(), {}, {}};
      if (visual.HasLaserRetro()) {
        shape.laser_retro = visual.LaserRetro();
      }
      shape.T_body_shape =
          T_body_model * resolve(visual.SemanticPose(), "__model__", shape.element, shape.path);
      add_shape(body, shape);
    }
  }

  void add_collisions(Body& body, const sdf::Link& link, const Pose& T_body_model,
                      const std::string& link_path) {
    for (std::uint64_t i = 0; i < link.CollisionCount(); ++i) {
      const sdf::Collision& collision = *link.CollisionByIndex(i);
      Shape shape{
          link_path + "::" + collision.Name(), collision.Element(), collision.Geom(), nullptr, {}, {}};
      shape.T_body_shape =
          T_body_model * resolve(collision.SemanticPose(), "__model__", shape.element, shape.path);
      add_shape(body, shape);
    }
  }

  void add_sonars(const Body& body, const sdf::Link& link, const Pose& T_body_model,
                  const std::string& link_path) {
    for (std::uint64_t i = 0; i < link.SensorCount(); ++i) {
      const sdf::Sensor& sensor = *link.SensorByIndex(i);
      if (const auto type = sonar_type(sensor.Element())) {
        const std::string path = link_path + "::" + sensor.Name();
        const Pose T_model_sonar = resolve(sensor.SemanticPose(), "__model__", sensor.Element(), path);
        world_.sonars.push_back({path, *type, body.name, T_body_model * T_model_sonar});
      }
    }
  }

  void add_shape(Body& body, const Shape& shape) {
    if (shape.geometry == nullptr) {
      fail(shape.element, shape.path, "there is no geometry");
    }
    if (const std::string kind = unsupported_geometry(*shape.geometry); !kind.empty()) {
      left_out_.add_geometry(kind, shape.path);
      return;
    }
    try {
      const auto normal_map = normal_map_of(shape);
      if (shape.geometry->Type() == sdf::GeometryType::HEIGHTMAP) {
        add_heightmap_shape(body, shape, normal_map);
        return;
      }
      for (const MeshFilePart& part : meshes_of(shape, normal_map != nullptr)) {
        body.parts.push_back(
            {part.mesh, shape.T_body_shape, material_of(shape, part.material_name), normal_map});
      }
    } catch (const WorldError& error) {
      fail(shape.element, shape.path, error.what());
    }
  }

  /// The name of a geometry that libsdformat knows and we do not; empty for all others.
  static std::string unsupported_geometry(const sdf::Geometry& geometry) {
    const auto element = geometry.Type() == sdf::GeometryType::EMPTY ? geometry.Element() : nullptr;
    const auto kind = element ? element->GetFirstElement() : nullptr;
    return kind && kind->GetName() != "empty" ? kind->GetName() : std::string();
  }

  /// The geometry as one or more meshes (a file has one per material).
  std::vector<MeshFilePart> meshes_of(const Shape& shape, bool tangents) {
    const sdf::Geometry& geometry = *shape.geometry;
    switch (geometry.Type()) {
      case sdf::GeometryType::BOX:
        return single(make_box(vec(geometry.BoxShape()->Size())), tangents);
      case sdf::GeometryType::SPHERE:
        return single(make_sphere(geometry.SphereShape()->Radius()), tangents);
      case sdf::GeometryType::ELLIPSOID:
        return single(make_ellipsoid(vec(geometry.EllipsoidShape()->Radii())), tangents);
      case sdf::GeometryType::CYLINDER:
        return single(make_cylinder(geometry.CylinderShape()->Radius(), geometry.CylinderShape()->Length()),
                      tangents);
      case sdf::GeometryType::CAPSULE:
        return single(make_capsule(geometry.CapsuleShape()->Radius(), geometry.CapsuleShape()->Length()),
                      tangents);
      case sdf::GeometryType::PLANE: {
        const auto size = geometry.PlaneShape()->Size();
        return single(make_plane({size.X(), size.Y()}, vec(geometry.PlaneShape()->Normal())), tangents);
      }
      case sdf::GeometryType::MESH:
        return mesh_file(*geometry.MeshShape(), tangents);
      case sdf::GeometryType::HEIGHTMAP:  // add_heightmap_shape()
      case sdf::GeometryType::EMPTY:
        break;
    }
    if (const auto element = geometry.Element(); !element || !element->GetFirstElement()) {
      throw WorldError("there is no geometry");
    }
    return {};
  }

  std::vector<MeshFilePart> single(TriangleMesh mesh, bool tangents) {
    mesh = validated_mesh(std::move(mesh), world_.diagnostics);
    if (mesh.indices.empty()) {
      throw WorldError("the shape is too small to have triangles");
    }
    if (tangents) {
      add_tangents(mesh);
    }
    return {{"", std::make_shared<const TriangleMesh>(std::move(mesh))}};
  }

  /// Its `pos` becomes part of the pose, which is in double precision: it may hold UTM coordinates.
  void add_heightmap_shape(Body& body, const Shape& shape, std::shared_ptr<const NormalMap> normal_map) {
    const sdf::Heightmap& map = *shape.geometry->HeightmapShape();
    const fs::path file = resolver_.resolve(map.Uri(), fs::path(map.FilePath()).parent_path());
    const Pose T_shape_map{vec(map.Position()), {1, 0, 0, 0}};
    add_heightmap(load_grey_image(file), vec(map.Size()),
                  {nullptr, shape.T_body_shape * T_shape_map, material_of(shape, ""), std::move(normal_map)},
                  world_, world_.bodies.size(), body.parts);
  }

  /// Each file is read once for all its uses with the same scale.
  std::vector<MeshFilePart> mesh_file(const sdf::Mesh& mesh, bool tangents) {
    const MeshFileRequest request{resolver_.resolve(mesh.Uri(), fs::path(mesh.FilePath()).parent_path()),
                                  mesh.Submesh(), mesh.CenterSubmesh(), vec(mesh.Scale()), tangents};
    for (const auto& [known, parts] : mesh_files_) {
      if (known == request) {
        return parts;
      }
    }
    MeshFile loaded = load_mesh_file(request);
    world_.diagnostics += loaded.diagnostics;
    world_.warnings.insert(world_.warnings.end(), loaded.warnings.begin(), loaded.warnings.end());
    mesh_files_.emplace_back(request, loaded.parts);
    return loaded.parts;
  }

  /// The order is the one of docs/worlds.md.
  AcousticMaterial material_of(const Shape& shape, const std::string& mesh_material) {
    if (auto own = own_material(shape.element, world_.warnings)) {
      return *own;
    }
    if (auto named = find_acoustic_material(mesh_material)) {
      return *named;
    }
    if (auto inherited = inherited_material(shape.element, world_.warnings)) {
      return *inherited;
    }
    if (shape.laser_retro) {
      std::vector<std::string> remarks;
      AcousticMaterial material = material_of_laser_retro(*shape.laser_retro, remarks);
      for (const std::string& remark : remarks) {
        world_.warnings.push_back(fmt::format("{}: {}: {}", place_of(shape.element), shape.path, remark));
      }
      return material;
    }
    if (!mesh_material.empty()) {
      world_.warnings.push_back(
          fmt::format("{}: {}: mesh material '{}' is no acoustic material: 'default' is used",
                      place_of(shape.element), shape.path, mesh_material));
    }
    return {};
  }

  std::shared_ptr<const NormalMap> normal_map_of(const Shape& shape) {
    if (shape.material == nullptr) {
      return nullptr;
    }
    const std::string uri = normal_map_uri(*shape.material);
    if (uri.empty()) {
      return nullptr;
    }
    const fs::path file = resolver_.resolve(uri, fs::path(shape.element->FilePath()).parent_path());
    auto& known = normal_maps_[file];
    if (!known) {
      known = std::make_shared<const NormalMap>(load_normal_map(file));
    }
    return known;
  }

  static std::string normal_map_uri(const sdf::Material& material) {
    bool in_object_space = material.Shader() == sdf::ShaderType::NORMAL_MAP_OBJECTSPACE;
    std::string uri = in_object_space || material.Shader() == sdf::ShaderType::NORMAL_MAP_TANGENTSPACE
                          ? material.NormalMap()
                          : std::string();
    for (const auto type : {sdf::PbrWorkflowType::METAL, sdf::PbrWorkflowType::SPECULAR}) {
      const sdf::PbrWorkflow* workflow =
          material.PbrMaterial() != nullptr ? material.PbrMaterial()->Workflow(type) : nullptr;
      if (workflow != nullptr && !workflow->NormalMap().empty()) {
        uri = workflow->NormalMap();
        in_object_space =
            workflow->Element()->FindElement("normal_map")->Get<std::string>("type") == "object";
        break;
      }
    }
    if (!uri.empty() && in_object_space) {
      throw WorldError("object-space normal maps are not supported: use one in tangent space");
    }
    return uri;
  }

  fs::path file_;
  UriResolver resolver_;
  World world_;
  LeftOut left_out_;
  std::vector<std::pair<MeshFileRequest, std::vector<MeshFilePart>>> mesh_files_;
  std::map<fs::path, std::shared_ptr<const NormalMap>> normal_maps_;
};

}  // namespace

World load_world(const fs::path& sdf_file, const std::vector<fs::path>& model_folders) {
  std::error_code error;
  const fs::path file = fs::canonical(sdf_file, error);
  if (error || !fs::is_regular_file(file, error)) {
    throw WorldError(fmt::format("{}: world file not found", sdf_file.string()));
  }
  return WorldBuilder(file, model_folders).build();
}

}  // namespace sonard::render
