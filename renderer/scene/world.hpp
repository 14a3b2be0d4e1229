// SPDX-License-Identifier: Apache-2.0
// The world for all engines: triangles with acoustic materials, grouped in bodies that move. It has no scene
// graph and no graphics types: each engine builds its own acceleration data from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "renderer/pose.hpp"
#include "renderer/scene/geographic_frame.hpp"

namespace sonard::render {

/// How a surface reflects sound. See docs/worlds.md for the named materials and their use in SDF files.
struct AcousticMaterial {
  std::string name = "default";
  /// Reflectance rho of mode `paper` (Cerqueira et al. 2017, 3.2): the echo intensity is min(1, rho cos phi).
  /// >= 0.
  double reflectance = 1.0;
  /// Lambert coefficient mu of mode `physical`: s_b = mu cos^2(phi). Linear, in [0, 1/pi] for a passive
  /// surface.
  double lambert_mu = 0.0063;
  /// Pressure reflection coefficient R of a plane, smooth surface, (Z2 - Z1) / (Z2 + Z1), in [-1, 1]
  /// (docs/physics.md 2.4). It sets the strength of facets and of mirror images; 0: neither.
  double pressure_reflection = 0.0;
  /// Rms slope m of the surface's facets along each of its two axes, in [0.01, 0.5]; sets the width of their
  /// echo.
  double rms_slope = 0.2;
  /// Rms height sigma of the surface, >= 0; a larger height weakens mirror images (docs/physics.md 2.11).
  double rms_height_m = 0.002;

  bool operator==(const AcousticMaterial&) const = default;
};

/// Triangles in the coordinates of the body part, metres. Validated: every index is in range, every position
/// is finite, no triangle has zero area. `normals`, `texcoords` and `tangents` are empty or as long as
/// `positions`. Without normals, engines use the geometric normal of each triangle.
struct TriangleMesh {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  ///< unit, outward
  std::vector<glm::vec2> texcoords;
  std::vector<glm::vec4> tangents;     ///< unit xyz, w = handedness of the bitangent (+1 or -1)
  std::vector<std::uint32_t> indices;  ///< three per triangle, counter-clockwise seen from outside

  std::size_t triangle_count() const { return indices.size() / 3; }
  /// Whether it has all attributes for a normal map: normals, tangents and texture coordinates.
  bool can_be_mapped() const { return !normals.empty() && !tangents.empty() && !texcoords.empty(); }
};

/// A tangent-space normal map, 8-bit RGB, row 0 at texture coordinate v = 0, repeated beyond [0, 1].
struct NormalMap {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> rgb;
};

struct BodyPart {
  std::shared_ptr<const TriangleMesh> mesh;
  Pose T_body_part;
  AcousticMaterial material;
  std::shared_ptr<const NormalMap> normal_map;  ///< null if there is no map
  glm::dvec3 scale{1.0};                        ///< scale already applied to a file's mesh, for messages
  bool is_mesh_file = false;                    ///< from a <mesh>, whose unit may be wrong
};

/// The new mesh of a part. Parts are counted through all bodies in the order of the world.
struct PartMesh {
  std::size_t part;
  std::shared_ptr<const TriangleMesh> mesh;  ///< may have no triangles; never null
};

/// One top-level model of the world. Its parts keep their relative poses; the whole can be moved at run time.
struct Body {
  std::string name;
  Pose T_world_body;
  std::vector<BodyPart> parts;
};

/// A sonar in the world file: <sensor type="custom" sonard:type="..."> (docs/worlds.md).
struct WorldSonar {
  std::string path;   ///< "rov::sonar_link::multibeam"; unique
  std::string type;   ///< the text of sonard:type, not checked
  std::string body;   ///< the body that carries it
  Pose T_body_sonar;  ///< x is the acoustic axis, z up
};

class Terrain;

/// A large heightmap among the parts of a body: one part per tile, consecutive. The world holds their
/// coarsest meshes; a renderer replaces those in range.
struct TerrainParts {
  std::shared_ptr<const Terrain> terrain;
  std::size_t body;
  std::size_t first_part;
};

/// Repairs and drops by a loader; shown by `sonard check`.
struct MeshDiagnostics {
  std::size_t degenerate_triangles = 0;  ///< zero area or repeated corner: dropped
  std::size_t non_finite_triangles = 0;  ///< NaN, infinite or above 1e12 m: dropped
  std::size_t bad_normals = 0;           ///< zero or non-finite: the geometric normal is used
  std::size_t bad_texcoords = 0;         ///< non-finite: 0 is used
  MeshDiagnostics& operator+=(const MeshDiagnostics& other);
};

struct World {
  std::string name;
  /// Position of its frame on Earth, if the file or the caller gave it.
  std::optional<GeographicOrigin> origin;
  std::vector<std::string> maps;  ///< one line about each georeferenced map
  std::vector<Body> bodies;       ///< names are unique
  std::vector<TerrainParts> terrains;
  /// Height of the water surface in the world frame; a sonar above it is out of the water.
  std::optional<double> water_surface_z_m;
  MeshDiagnostics diagnostics;
  std::vector<WorldSonar> sonars;
  std::vector<std::string> warnings;  ///< one line each, with the file name
  /// Elements of the file without an echo ("lights (2): sun, lamp"), one line per kind.
  std::vector<std::string> left_out;

  /// Triangles of all parts; a terrain counts with the meshes that its parts hold.
  std::size_t triangle_count() const;
  bool is_terrain(std::size_t body, std::size_t part_of_body) const;
  /// Number of parts of all bodies.
  std::size_t part_count() const;
  /// nullptr if no body has this name.
  const Body* find_body(const std::string& body_name) const;
};

void replace_meshes(World& world, std::span<const PartMesh> changes);

/// Thrown by all functions that load a world. what() is one line: "file:line: message" as far as known.
struct WorldError : std::runtime_error {
  using std::runtime_error::runtime_error;
  /// @param lines at least one
  explicit WorldError(std::vector<std::string> lines, std::vector<std::string> remarks = {})
      : std::runtime_error(lines.front()),
        more(lines.begin() + 1, lines.end()),
        warnings(std::move(remarks)) {}

  std::vector<std::string> more{};      ///< further problems, in the same form
  std::vector<std::string> warnings{};  ///< World::warnings up to the error
};

/// How the loader treats an include, or a mesh, with a missing file.
enum class MissingFiles {
  error,
  skip  ///< loads the world without it and adds a warning
};

/// Limit per world; 50 million take about 3 GB of memory and minutes to load.
constexpr std::size_t default_max_triangles = 50'000'000;

/// Folders in the environment variables GZ_SIM_RESOURCE_PATH, IGN_GAZEBO_RESOURCE_PATH, GAZEBO_MODEL_PATH,
/// GAZEBO_RESOURCE_PATH (with `media` and `Media` in each, if they exist), SDF_PATH, GZ_FILE_PATH and
/// IGN_FILE_PATH (colon separated), in this order, then ~/.gazebo/models if it exists.
std::vector<std::filesystem::path> model_folders_from_environment();

/// Loads an SDF 1.x world file (or a file with a single model) and all it includes; see docs/worlds.md. Bare
/// names and relative URIs are searched in the folder of the file that names them. These and `model://NAME`
/// are then searched in the folder of the world, in `models` there and beside it, and in `model_folders`. A
/// model of Fuel is searched in Gazebo's local cache. Nothing is downloaded. Mesh files are read in forked
/// child processes: call this before other threads are started. `origin` replaces the file's
/// <spherical_coordinates>.
/// A world may have no triangles, and has at most `max_triangles`, counting each use of a mesh.
/// @throws WorldError with file, line and element for each missing mesh, unknown material, ...
World load_world(const std::filesystem::path& sdf_file,
                 const std::vector<std::filesystem::path>& model_folders = model_folders_from_environment(),
                 MissingFiles missing = MissingFiles::error,
                 const std::optional<GeographicOrigin>& origin = std::nullopt,
                 std::size_t max_triangles = default_max_triangles);

}  // namespace sonard::render
