// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "renderer/scene/grouped_warnings.hpp"
#include "renderer/scene/image_file.hpp"
#include "renderer/scene/left_out.hpp"
#include "renderer/scene/local_file.hpp"
#include "renderer/scene/map_placement.hpp"
#include "renderer/scene/materials.hpp"
#include "renderer/scene/mesh.hpp"
#include "renderer/scene/mesh_file.hpp"
#include "renderer/scene/primitives.hpp"
#include "renderer/scene/sdf_document.hpp"
#include "renderer/scene/sdf_elements.hpp"
#include "renderer/scene/sdf_frames.hpp"
#include "renderer/scene/sdf_material.hpp"
#include "renderer/scene/sdf_shapes.hpp"
#include "renderer/scene/sdf_state.hpp"
#include "renderer/scene/terrain.hpp"
#include "renderer/scene/uri_resolver.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {
namespace {

namespace fs = std::filesystem;

/// A visual, or a collision in its place.
struct Shape {
  std::string path;  ///< "model::link::visual"
  const SdfElement& element;
  const SdfElement* geometry = nullptr;  ///< <box>, <mesh>, ...
  Pose T_body_shape;
};

/// Loading stops: no further shape may be added.
struct TooManyTriangles : WorldError {
  using WorldError::WorldError;
};

/// Reads <spherical_coordinates>; nullopt, with a warning, if they are not supported.
std::optional<GeographicOrigin> origin_of(const SdfElement& place, std::vector<std::string>& warnings) {
  const auto ignored = [&](const std::string& why) {
    warnings.push_back(fmt::format("{}: <spherical_coordinates> is not used: {}", place.place(), why));
    return std::nullopt;
  };
  if (const std::string model = text_of(place, "surface_model"); !model.empty() && model != "EARTH_WGS84") {
    return ignored(fmt::format("surface_model {} (expected EARTH_WGS84)", model));
  }
  if (const std::string axes = text_of(place, "world_frame_orientation"); !axes.empty() && axes != "ENU") {
    return ignored(fmt::format("world_frame_orientation {} (expected ENU)", axes));
  }
  if (const double heading_deg = number_of(place, "heading_deg", 0); heading_deg != 0.0) {
    return ignored(fmt::format("heading_deg {} (expected 0)", heading_deg));
  }
  const GeographicOrigin origin{number_of(place, "latitude_deg", 0), number_of(place, "longitude_deg", 0),
                                number_of(place, "elevation", 0)};
  if (std::abs(origin.latitude_deg) > 90.0 || std::abs(origin.longitude_deg) > 180.0) {
    return ignored(fmt::format("{}, {} is not a place on Earth", origin.latitude_deg, origin.longitude_deg));
  }
  return origin;
}

class WorldBuilder {
 public:
  WorldBuilder(const fs::path& file, const std::vector<fs::path>& model_folders, MissingFiles missing,
               const std::optional<GeographicOrigin>& origin, std::size_t max_triangles)
      : file_(file), resolver_(file, model_folders), missing_(missing), max_triangles_(max_triangles) {
    world_.origin = origin;
  }

  World build() {
    const std::unique_ptr<SdfElement> sdf = read_sdf(file_, resolver_, missing_, world_.warnings, problems_);
    if (SdfElement* const world = sdf->child("world")) {
      attempt([&] { state_.apply(*world, world_.warnings); });
    }
    check_own_elements(*sdf, problems_);
    add_warnings(unknown_elements(*sdf));
    add_warnings(look_alikes(*sdf));
    try {
      const SdfElement& top = world_or_model(*sdf);
      warn_of_other_models(*sdf, top);
      require_few_triangles(top);
      add_bodies(top);
    } catch (const TooManyTriangles& error) {
      problems_.add(error.what());
    }
    add_warnings(grouped_.lines());
    tell_what_may_lie();
    drop_repeated_warnings();
    if (!problems_.empty()) {
      throw WorldError(problems_.lines(), std::move(world_.warnings));
    }
    tell_what_is_left_out(*sdf);
    return std::move(world_);
  }

 private:
  void add_warnings(const std::vector<std::string>& lines) {
    world_.warnings.insert(world_.warnings.end(), lines.begin(), lines.end());
  }

  /// @throws WorldError
  const SdfElement& world_or_model(const SdfElement& sdf) const {
    const auto worlds =
        std::ranges::count(sdf.children, "world", [](const auto& child) { return child->name; });
    const SdfElement* const only = worlds > 0 ? sdf.child("world") : sdf.child("model");
    if (worlds > 1 || only == nullptr) {
      std::vector<std::string> lines = problems_.lines();
      lines.push_back(fmt::format("{}: {}: expected one world or one model", file_.string(),
                                  worlds > 1 ? fmt::format("{} worlds", worlds) : "no world and no model"));
      throw WorldError(std::move(lines));
    }
    return *only;
  }

  /// Warns of models beside `top`, the world or model that is loaded.
  void warn_of_other_models(const SdfElement& sdf, const SdfElement& top) {
    for (const auto& child : sdf.children) {
      if (child->name == "model" && child.get() != &top) {
        world_.warnings.push_back(
            fmt::format("{}: model '{}' is left out, because {}", child->place(), child->given_name(),
                        top.name == "world" ? "it is outside of <world>; move it into <world>"
                                            : "a file without <world> has one model; put all models "
                                              "into a <world>"));
      }
    }
  }

  /// Stops before triangles are made: so many would take minutes and all memory.
  /// @throws TooManyTriangles
  void require_few_triangles(const SdfElement& top) {
    std::size_t count = 0;
    const auto add = [&](const SdfElement& model) {
      count += primitive_triangles_below(model, has_shape(model, "visual") ? "visual" : "collision");
      if (count > max_triangles_) {
        throw_too_many(model.given_name());
      }
    };
    if (top.name == "model") {
      add(top);
    }
    for (const auto& child : top.children) {
      if (child->name == "model" && top.name != "model") {
        add(*child);
      }
    }
  }

  [[noreturn]] void throw_too_many(const std::string& path) const {
    throw TooManyTriangles(fmt::format(
        "{}: the world has more than {} triangles, from {} on (world.max_triangles sets the maximum)",
        file_.string(), max_triangles_, path));
  }

  /// @throws TooManyTriangles
  void count_triangles(const std::vector<BodyPart>& parts, std::size_t first, const std::string& path) {
    for (std::size_t i = first; i < parts.size(); ++i) {
      triangles_ += parts[i].mesh->triangle_count();
    }
    if (triangles_ > max_triangles_) {
      throw_too_many(path);
    }
  }

  void add_bodies(const SdfElement& top) {
    world_.name = top.given_name();
    if (top.name == "model") {
      add_body(top);
      return;
    }
    attempt([&] { world_.water_surface_z_m = water_surface_z_m(top); });
    if (const SdfElement* const place = top.child("spherical_coordinates");
        place != nullptr && !world_.origin) {
      attempt([&] { world_.origin = origin_of(*place, world_.warnings); });
    }
    for (const auto& child : top.children) {
      if (child->name == "model") {
        add_body(*child);
      }
    }
  }

  /// A material that a model passes down is read, with its warnings, once per visual.
  void drop_repeated_warnings() {
    std::set<std::string> seen;
    std::erase_if(world_.warnings, [&](const std::string& line) { return !seen.insert(line).second; });
  }

  /// As in Gazebo, the axes of COLLADA are not applied.
  void tell_what_may_lie() {
    for (const auto& [up_axis, files] : up_axis_files_) {
      world_.warnings.push_back(fmt::format(
          "{}: <up_axis> {} is not applied, as in Gazebo, to {}; if such a mesh lies on its side, turn it by "
          "<pose>{}</pose> in its <visual>",
          file_.string(), up_axis, fmt::join(files, ", "),
          up_axis == "Y_UP" ? "0 0 0 1.5708 0 0" : "0 0 0 0 -1.5708 0"));
    }
  }

  void tell_what_is_left_out(const SdfElement& sdf) {
    left_out_.add_elements_of(sdf);
    world_.left_out = left_out_.silent();
    for (const std::string& line : left_out_.audible()) {
      world_.warnings.push_back(fmt::format("{}: left out: {}", file_.string(), line));
    }
  }

  /// Runs `work`. If it throws, it is left out, and the error is reported with the others.
  /// @return false if it depends on a missing model
  template <class Work>
  bool attempt(const Work& work) {
    try {
      work();
    } catch (const MissingFile& error) {
      if (missing_ == MissingFiles::skip) {
        world_.warnings.emplace_back(error.what());
      }
      return false;  // if it is required, its include has reported the problem
    } catch (const TooManyTriangles&) {
      throw;
    } catch (const WorldError& error) {
      problems_.add(error.what());
    }
    return true;
  }

  /// Runs `work`, and adds place and path to its errors.
  template <class Work>
  void attempt(const SdfElement& element, const std::string& path, const Work& work) {
    try {
      work();
    } catch (const MissingFile& error) {
      if (missing_ == MissingFiles::skip) {
        grouped_.add(fmt::format("shapes are left out: {}", error.what()), element.place(), path);
      } else {
        problems_.add(fmt::format("{}: {}: {}{}", element.place(), path, error.what(), how_to_skip));
      }
    } catch (const ShapeOfNothing& error) {
      grouped_.add(
          fmt::format("a shape without a surface is left out: {}; correct it, or remove it", error.what()),
          element.place(), path);
    } catch (const TooManyTriangles&) {
      throw;
    } catch (const WorldError& error) {
      problems_.add(fmt::format("{}: {}: {}", element.place(), path, error.what()));
    }
  }

  /// The name; a problem if it is missing or taken.
  std::string name_of(const SdfElement& element, const std::string& path, std::set<std::string>& taken) {
    const std::string name = element.given_name();
    if (name.empty()) {
      problems_.add(fmt::format("{}: {}a {} without a name", element.place(), path.empty() ? "" : path + ": ",
                                element.name));
    } else if (!taken.insert(name).second) {
      problems_.add(fmt::format("{}: another {} is called '{}': {}", element.place_in_scope(),
                                path.empty() ? "model" : "part of " + path, name,
                                element.inclusion ? element.inclusion->to_rename : "rename one of them"));
    }
    return name;
  }

  void add_body(const SdfElement& model) {
    Body body{name_of(model, "", body_names_), {}, {}};
    if (!attempt([&] { body.T_world_body = T_world_of(model, body.name); })) {
      return;
    }
    const bool visible = has_shape(model, "visual");
    if (!visible && has_shape(model, "collision")) {
      world_.warnings.push_back(fmt::format("{}: {}: the model has no visual: its collision shapes are used",
                                            model.place(), body.name));
    } else if (!visible) {
      left_out_.add_silent("models without shapes", body.name);
    }
    add_model(body, model, Pose{}, body.name, visible);
    world_.bodies.push_back(std::move(body));
  }

  /// The pose in <state>, else the model's own <pose>.
  Pose T_world_of(const SdfElement& model, const std::string& name) {
    const Pose& T_world_model = frames_.T_scope(model);
    const Pose* const saved = state_.T_world(model);
    if (saved == nullptr) {
      return T_world_model;
    }
    constexpr double same = 1e-6;  // metres, and half of an angle in radians
    if (glm::distance(saved->position_m, T_world_model.position_m) > same ||
        std::abs(glm::dot(saved->orientation, T_world_model.orientation)) < 1.0 - same * same) {
      left_out_.add_silent("poses of models for which <state> has others", name);
    }
    return *saved;
  }

  void add_model(Body& body, const SdfElement& model, const Pose& T_body_model, const std::string& path,
                 bool visible) {
    std::set<std::string> names;
    for (const auto& child : model.children) {
      if (child->name != "link" && child->name != "model") {
        continue;
      }
      const std::string child_path = path + "::" + name_of(*child, path, names);
      const Pose* const T_world_child = state_.T_world(*child);
      attempt([&] {
        if (child->name == "model") {
          const Pose T_body_child = T_world_child == nullptr ? T_body_model * frames_.T_scope(*child)
                                                             : inverse(body.T_world_body) * *T_world_child;
          add_model(body, *child, T_body_child, child_path, visible);
          return;
        }
        // The model frame as seen from the link: if <state> has moved the link, its shapes move with it.
        const Pose T_body_frame = T_world_child == nullptr ? T_body_model
                                                           : inverse(body.T_world_body) * *T_world_child *
                                                                 inverse(frames_.T_scope(*child));
        add_shapes(body, *child, visible ? "visual" : "collision", T_body_frame, child_path);
        add_sonars(body, *child, T_body_frame, child_path);
      });
    }
  }

  void add_shapes(Body& body, const SdfElement& link, std::string_view kind, const Pose& T_body_model,
                  const std::string& path) {
    for (const auto& child : link.children) {
      if (child->name == kind) {
        attempt([&] {
          Shape shape{path + "::" + child->given_name(), *child, nullptr,
                      T_body_model * frames_.T_model(*child)};
          attempt(*child, shape.path, [&] {
            const std::size_t first = body.parts.size();
            add_shape(body, shape);
            count_triangles(body.parts, first, shape.path);
          });
        });
      }
    }
  }

  void add_sonars(const Body& body, const SdfElement& link, const Pose& T_body_model,
                  const std::string& path) {
    for (const auto& child : link.children) {
      if (const auto type = sonar_type(*child)) {
        attempt([&] {
          world_.sonars.push_back(
              {path + "::" + child->given_name(), *type, body.name, T_body_model * frames_.T_model(*child)});
        });
      }
    }
  }

  /// @throws WorldError without a place
  void add_shape(Body& body, Shape& shape) {
    const SdfElement* const geometry = shape.element.child("geometry");
    if (geometry == nullptr || geometry->children.empty()) {
      throw ShapeOfNothing("its <geometry> is missing or empty");
    }
    shape.geometry = geometry->children.front().get();
    const std::string& kind = shape.geometry->name;
    if (kind == "empty") {
      return;
    }
    const auto normal_map = normal_map_of(shape);
    if (kind == "heightmap") {
      add_heightmap_shape(body, shape, normal_map);
      return;
    }
    const auto parts = meshes_of(*shape.geometry, normal_map != nullptr);
    if (!parts) {
      left_out_.add_geometry(kind, shape.path);
      return;
    }
    for (const MeshFilePart& part : *parts) {
      body.parts.push_back({part.mesh, shape.T_body_shape, material_of(shape, part.material_name),
                            part.mesh->tangents.empty() ? nullptr : normal_map, part.scale, kind == "mesh"});
    }
  }

  /// The geometry as one or more meshes (a file has one per material); nullopt if the kind is not supported.
  /// Equal shapes share a mesh.
  std::optional<std::vector<MeshFilePart>> meshes_of(const SdfElement& geometry, bool tangents) {
    if (geometry.name == "mesh") {
      return mesh_file(geometry, tangents);
    }
    std::string key = geometry.name + (tangents ? " with tangents" : "");
    for (const auto& child : geometry.children) {
      key += fmt::format(" {} {}", child->name, child->text);
    }
    if (const auto known = primitives_.find(key); known != primitives_.end()) {
      return known->second;
    }
    auto mesh = primitive_of(geometry);
    return mesh ? std::optional(primitives_.emplace(key, single(std::move(*mesh), tangents)).first->second)
                : std::nullopt;
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

  /// The file in a <uri>.
  fs::path file_of(const SdfElement& geometry) const {
    return resolver_.resolve(text_of(geometry, "uri"), geometry.folder());
  }

  /// Adds `pos` to the pose, which is in double precision, because `pos` may hold UTM coordinates. An
  /// elevation map without a `size` lies at its georeference, moved by the poses.
  void add_heightmap_shape(Body& body, const Shape& shape, std::shared_ptr<const NormalMap> normal_map) {
    const fs::path file = file_of(*shape.geometry);
    Pose T_shape_map{vec3_of(*shape.geometry, "pos", {0, 0, 0}), {1, 0, 0, 0}};
    glm::dvec3 size_m = vec3_of(*shape.geometry, "size", {1, 1, 1});
    GreyImage picture;
    if (is_elevation_map(file)) {
      ElevationMap map = load_elevation_map(file);
      if (shape.geometry->child("size") == nullptr) {
        const MapPlacement placement = placement_of(map, file);
        T_shape_map = T_shape_map * placement.T_world_map;
        size_m = placement.size_m;
      }
      picture = std::move(map.picture);
    } else {
      picture = load_grey_image(file);
    }
    add_heightmap(std::move(picture), size_m,
                  {nullptr, shape.T_body_shape * T_shape_map, material_of(shape, ""), std::move(normal_map)},
                  world_, world_.bodies.size(), body.parts);
  }

  /// If the world has no position on Earth, the map's middle is the origin, at altitude 0.
  MapPlacement placement_of(const ElevationMap& map, const fs::path& file) {
    if (!map.georeference) {
      throw WorldError(fmt::format("{}: {}; give the <size> of the heightmap to place it by hand",
                                   file.string(), map.no_georeference_because));
    }
    const MapPlacement placement =
        place_map(map, GeographicFrame(world_.origin ? *world_.origin : middle_of(map)));
    world_.maps.push_back(fmt::format("{}: {}", file.filename().string(), describe(map, placement)));
    return placement;
  }

  /// Each file is read, and reported, once for all uses with the same scale.
  std::vector<MeshFilePart> mesh_file(const SdfElement& mesh, bool tangents) {
    const SdfElement* const submesh = mesh.child("submesh");
    const std::string centre = submesh == nullptr ? "" : text_of(*submesh, "center");
    std::string name = submesh == nullptr ? "" : text_of(*submesh, "name");
    const bool is_whole = name == "__default__";  // written by Gazebo Classic
    const glm::dvec3 scale = vec3_of(mesh, "scale", {1, 1, 1});
    if (scale.x * scale.y * scale.z == 0.0) {
      throw ShapeOfNothing("a number of the <scale> of its mesh is 0");
    }
    const MeshFileRequest request{file_of(mesh),
                                  is_whole ? "" : std::move(name),
                                  !is_whole && (centre == "true" || centre == "1"),
                                  scale,
                                  tangents,
                                  resolver_.folders()};
    for (const auto& [known, parts] : mesh_files_) {
      if (known == request) {
        return parts;
      }
    }
    MeshFile loaded = load_mesh_file(request);
    for (MeshFilePart& part : loaded.parts) {
      part.scale = request.scale;
    }
    world_.diagnostics += loaded.diagnostics;
    world_.warnings.insert(world_.warnings.end(), loaded.warnings.begin(), loaded.warnings.end());
    if (!loaded.up_axis.empty()) {
      up_axis_files_[loaded.up_axis].insert(request.file.filename().string());
    }
    mesh_files_.emplace_back(request, loaded.parts);
    return loaded.parts;
  }

  /// In the order of docs/worlds.md.
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
    if (shape.element.name == "visual" && shape.element.child("laser_retro") != nullptr) {
      if (const auto material = material_by_laser_retro(shape)) {
        return *material;
      }
    }
    if (!mesh_material.empty()) {
      grouped_.add(
          "mesh materials are not acoustic materials, so 'default' is used; write <sonard:material> into "
          "their visuals or models",
          shape.element.place(), fmt::format("'{}' ({})", mesh_material, shape.path));
    }
    return {};
  }

  /// nullopt, with a warning, if the value is not a number >= 0, because it is meant for lasers.
  std::optional<AcousticMaterial> material_by_laser_retro(const Shape& shape) {
    const std::string name = fmt::format("{} ({})", text_of(shape.element, "laser_retro"), shape.path);
    try {
      std::vector<std::string> remarks;
      AcousticMaterial material =
          material_of_laser_retro(number_of(shape.element, "laser_retro", 0), remarks);
      if (!remarks.empty()) {
        grouped_.add(
            "laser_retro is far above the usual 0 to 2.5, so these surfaces scatter all energy; write "
            "<sonard:material> instead",
            shape.element.place(), name);
      }
      return material;
    } catch (const WorldError&) {
      grouped_.add(
          "laser_retro is not used, because it is not a number >= 0; write <sonard:material> instead",
          shape.element.place(), name);
      return std::nullopt;
    }
  }

  /// A normal map only refines a surface: a map that cannot be used is left out, with a warning.
  std::shared_ptr<const NormalMap> normal_map_of(const Shape& shape) {
    const SdfElement* const material =
        shape.element.name == "visual" ? shape.element.child("material") : nullptr;
    try {
      const std::string uri = material == nullptr ? "" : normal_map_uri(*material);
      return uri.empty() ? nullptr : normal_map_file(resolver_.resolve(uri, shape.element.folder()));
    } catch (const WorldError& error) {
      grouped_.add(
          fmt::format("the normal map is left out: {}; correct or remove <normal_map>", error.what()),
          shape.element.place(), shape.path);
      return nullptr;
    }
  }

  /// Reads each file once.
  std::shared_ptr<const NormalMap> normal_map_file(const fs::path& file) {
    auto& known = normal_maps_[file];
    if (!known) {
      known = std::make_shared<const NormalMap>(load_normal_map(file));
    }
    return known;
  }

  static std::string normal_map_uri(const SdfElement& material) {
    const SdfElement* const shader = material.child("shader");
    const std::string* const type = shader == nullptr ? nullptr : shader->attribute("type");
    bool in_object_space = type != nullptr && *type == "normal_map_object_space";
    std::string uri = in_object_space || (type != nullptr && *type == "normal_map_tangent_space")
                          ? text_of(*shader, "normal_map")
                          : "";
    const SdfElement* const pbr = material.child("pbr");
    for (const char* workflow : {"metal", "specular"}) {
      const SdfElement* const named = pbr == nullptr ? nullptr : pbr->child(workflow);
      const SdfElement* const map = named == nullptr ? nullptr : named->child("normal_map");
      if (map != nullptr && !map->text.empty()) {
        uri = map->text;
        const std::string* const space = map->attribute("type");
        in_object_space = space != nullptr && *space == "object";
        break;
      }
    }
    // Programs write "__default__" for a shader without its own map.
    uri = uri == "__default__" ? "" : uri;
    if (!uri.empty() && in_object_space) {
      throw WorldError("object-space normal maps are not supported: use one in tangent space");
    }
    return uri;
  }

  fs::path file_;
  UriResolver resolver_;
  const MissingFiles missing_;
  const std::size_t max_triangles_;
  std::size_t triangles_ = 0;
  World world_;
  LeftOut left_out_;
  GroupedWarnings grouped_;
  SdfFrames frames_;
  SavedState state_;
  WorldProblems problems_;
  std::set<std::string> body_names_;
  std::map<std::string, std::vector<MeshFilePart>> primitives_;
  std::vector<std::pair<MeshFileRequest, std::vector<MeshFilePart>>> mesh_files_;
  std::map<fs::path, std::shared_ptr<const NormalMap>> normal_maps_;
  std::map<std::string, std::set<std::string>> up_axis_files_;
};

}  // namespace

World load_world(const fs::path& sdf_file, const std::vector<fs::path>& model_folders, MissingFiles missing,
                 const std::optional<GeographicOrigin>& origin, std::size_t max_triangles) {
  std::error_code error;
  const fs::path file = fs::canonical(sdf_file, error);
  if (error || !fs::is_regular_file(file, error)) {
    require_reachable(sdf_file);
    if (!error && fs::is_directory(file, error)) {
      throw WorldError(fmt::format("{}: is a folder (expected an SDF file)", sdf_file.string()));
    }
    const fs::path full = fs::absolute(sdf_file, error).lexically_normal();
    throw WorldError(fmt::format("{}: world file not found{}", sdf_file.string(),
                                 error || full == sdf_file ? "" : ", looked for " + full.string()));
  }
  return WorldBuilder(file, model_folders, missing, origin, max_triangles).build();
}

}  // namespace sonard::render
