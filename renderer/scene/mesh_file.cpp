// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/mesh_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "renderer/scene/collada_asset.hpp"
#include "renderer/scene/local_file.hpp"
#include "renderer/scene/mesh.hpp"
#include "renderer/scene/mesh_readers.hpp"
#include "renderer/scene/uri_resolver.hpp"

namespace sonard::render {
namespace {

constexpr std::size_t many_triangles = 2'000'000;
constexpr std::size_t max_triangles = 50'000'000;
/// Beyond this, float coordinates are coarser than 4 mm: half a range cell of a high-frequency sonar.
constexpr double far_from_origin_m = 32768.0;

/// Middle of the bounding box of all vertices that triangles use and that are finite.
glm::dvec3 box_centre(const RawMesh& raw) {
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high(-std::numeric_limits<double>::infinity());
  for (const RawPart& part : raw.parts) {
    for (const std::uint32_t index : part.indices) {
      if (index < part.positions.size() && std::isfinite(glm::dot(part.positions[index], glm::dvec3(1.0)))) {
        low = glm::min(low, part.positions[index]);
        high = glm::max(high, part.positions[index]);
      }
    }
  }
  return low.x <= high.x ? 0.5 * (low + high) : glm::dvec3(0.0);
}

TriangleMesh scaled(RawPart part, const glm::dvec3& origin, const glm::dvec3& scale) {
  TriangleMesh mesh;
  mesh.positions.reserve(part.positions.size());
  for (const glm::dvec3& p : part.positions) {
    mesh.positions.emplace_back((p - origin) * scale);
  }
  mesh.normals = std::move(part.normals);
  for (glm::vec3& normal : mesh.normals) {
    normal = glm::vec3(glm::dvec3(normal) / scale);
  }
  mesh.texcoords = std::move(part.texcoords);
  mesh.indices = std::move(part.indices);
  if (scale.x * scale.y * scale.z < 0.0) {
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    }
  }
  return mesh;
}

bool is_far(const TriangleMesh& mesh) {
  return std::any_of(mesh.positions.begin(), mesh.positions.end(), [](const glm::vec3& p) {
    return static_cast<double>(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)})) > far_from_origin_m;
  });
}

/// Each name once, in the order of the file, without the file's own name, which Assimp gives to the root.
std::vector<std::string> names_in(const RawMesh& raw, const std::filesystem::path& file) {
  std::vector<std::string> names;
  for (const std::string& name : raw.names) {
    if (name != file.filename() && std::ranges::find(names, name) == names.end()) {
      names.push_back(name);
    }
  }
  return names;
}

void require_parts(const RawMesh& raw, const MeshFileRequest& request) {
  std::size_t triangles = 0;
  for (const RawPart& part : raw.parts) {
    triangles += part.indices.size() / 3;
  }
  if (triangles > max_triangles) {
    throw WorldError(fmt::format("{} triangles, more than the maximum of {}", triangles, max_triangles));
  }
  if (triangles == 0 && !request.submesh.empty()) {
    throw MissingFile(fmt::format("no submesh '{}' with triangles; names in the file: {}", request.submesh,
                                  fmt::join(names_in(raw, request.file), ", ")));
  }
}

MeshFile load_checked(const MeshFileRequest& request) {
  MeshFile loaded;
  const std::string extension = lower_extension(request.file);
  // As in Gazebo, the unit is applied, but not the axes.
  const ColladaAsset asset = extension == "dae" ? read_collada_asset(request.file) : ColladaAsset();
  loaded.up_axis = asset.up_axis == "Z_UP" ? "" : asset.up_axis;
  RawMesh raw = read_mesh({request.file, request.submesh, request.folders});
  for (const std::string& warning : raw.warnings) {
    loaded.warnings.push_back(fmt::format("{}: {}", request.file.string(), warning));
  }
  require_parts(raw, request);

  const glm::dvec3 origin = request.center_submesh ? box_centre(raw) : glm::dvec3(0.0);
  std::size_t triangles = 0;
  bool far = false;
  bool bare = false;
  for (RawPart& part : raw.parts) {
    std::string material_name = part.material_name;
    TriangleMesh mesh =
        validated_mesh(scaled(std::move(part), origin, request.scale * asset.unit_m), loaded.diagnostics);
    if (mesh.indices.empty()) {
      continue;
    }
    if (request.tangents && !mesh.texcoords.empty()) {
      add_tangents(mesh);
    }
    bare = bare || (request.tangents && mesh.tangents.empty());
    triangles += mesh.triangle_count();
    far = far || is_far(mesh);
    loaded.parts.push_back({std::move(material_name), std::make_shared<const TriangleMesh>(std::move(mesh))});
  }
  if (triangles == 0) {
    throw MissingFile("the mesh has no triangles");
  }
  if (bare) {
    loaded.warnings.push_back(
        fmt::format("{}: the normal map is left out on parts without texture coordinates; export the mesh "
                    "with them, or remove <normal_map>",
                    request.file.string()));
  }
  if (triangles > many_triangles) {
    loaded.warnings.push_back(
        fmt::format("{}: {} triangles; pings will be slow", request.file.string(), triangles));
  }
  if (far) {
    loaded.warnings.push_back(
        fmt::format("{}: vertices lie farther than {} m from the mesh origin, where single precision is "
                    "coarser than a range cell; "
                    "export the mesh near its origin and use the pose of the model",
                    request.file.string(), far_from_origin_m));
  }
  return loaded;
}

}  // namespace

MeshFile load_mesh_file(const MeshFileRequest& request) {
  require_local_file(request.file, mesh_extensions(), "mesh");
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(request.scale[axis]) || request.scale[axis] == 0.0) {
      throw WorldError(fmt::format("{}: scale {} {} {}: expected finite numbers other than 0",
                                   request.file.string(), request.scale.x, request.scale.y, request.scale.z));
    }
  }
  try {
    return load_checked(request);
  } catch (const MissingFile& error) {
    throw MissingFile(fmt::format("{}: {}", request.file.string(), error.what()));
  } catch (const std::runtime_error& error) {
    throw WorldError(fmt::format("{}: {}", request.file.string(), error.what()));
  }
}

}  // namespace sonard::render
