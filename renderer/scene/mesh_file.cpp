// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <regex>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "renderer/scene/assimp_mesh_reader.hpp"
#include "renderer/scene/isolated.hpp"
#include "renderer/scene/local_file.hpp"
#include "renderer/scene/mesh.hpp"
#include "renderer/scene/osg_mesh_reader.hpp"

namespace sonard::render {
namespace {

constexpr std::array<std::string_view, 11> mesh_extensions{"obj", "stl",  "ply",  "dae", "glb", "gltf",
                                                           "fbx", "osgt", "osgb", "ive", "3ds"};
constexpr std::size_t many_triangles = 2'000'000;
constexpr std::size_t max_triangles = 50'000'000;
/// Beyond this a float coordinate is coarser than 4 mm: half a range cell of a high-frequency sonar.
constexpr double far_from_origin_m = 32768.0;

/// Up to `limit` bytes from the start of a file.
std::string head_of(const std::filesystem::path& file, std::size_t limit) {
  std::ifstream in(file, std::ios::binary);
  std::string text(limit, '\0');
  in.read(text.data(), static_cast<std::streamsize>(limit));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

/// The plugin reads what is there of a truncated binary STL without a word.
void check_binary_stl(const std::filesystem::path& file) {
  const std::string head = head_of(file, 84);
  if (head.size() < 84 || head.starts_with("solid")) {
    return;
  }
  std::array<unsigned char, 4> count_bytes{};
  std::memcpy(count_bytes.data(), head.data() + 80, count_bytes.size());
  const std::uint64_t count = count_bytes[0] | (count_bytes[1] << 8U) | (count_bytes[2] << 16U) |
                              (static_cast<std::uint64_t>(count_bytes[3]) << 24U);
  const std::uint64_t size = std::filesystem::file_size(file);
  if (size < 84 + 50 * count) {
    throw WorldError(fmt::format("the file is cut short: {} triangles need {} bytes, there are {}", count,
                                 84 + 50 * count, size));
  }
}

/// The plugin reads "nan" and "inf" in a text file as 0.
void check_text_ply(const std::filesystem::path& file) {
  std::ifstream in(file);
  bool is_text = false;
  bool in_header = true;
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (in_header) {
      is_text = is_text || line.starts_with("format ascii");
      in_header = !line.starts_with("end_header");
      if (!in_header && !is_text) {
        return;
      }
    } else if (line.find_first_of("nNiI") != std::string::npos) {
      throw WorldError(fmt::format("line {}: '{}' is not made of finite numbers", number,
                                   line.substr(0, std::min<std::size_t>(line.find_first_of("\r\n"), 60))));
    }
  }
}

/// The PLY plugin invents smooth normals, over sharp edges too, when the file has none.
bool ply_has_normals(const std::filesystem::path& file) {
  const std::string head = head_of(file, 16384);
  const std::size_t end = head.find("end_header");
  static const std::regex property(R"(property\s+\w+\s+nx\b)");
  return std::regex_search(head.substr(0, end), property);
}

std::string without_comments(std::string xml) {
  for (std::size_t begin = xml.find("<!--"); begin != std::string::npos; begin = xml.find("<!--", begin)) {
    const std::size_t end = xml.find("-->", begin + 4);
    xml.erase(begin, end == std::string::npos ? std::string::npos : end + 3 - begin);
  }
  return xml;
}

/// Metres per unit of a COLLADA file, which its plugin does not apply. Only the first <asset> counts: it is
/// the document's; those of libraries inside come later.
double collada_unit_m(const std::filesystem::path& file) {
  const std::string head = without_comments(head_of(file, 65536));
  const std::size_t asset = head.find("<asset");
  const std::size_t unit = head.find("<unit", asset);
  if (asset == std::string::npos || unit == std::string::npos || unit > head.find("</asset>", asset)) {
    return 1.0;
  }
  const std::string tag = head.substr(unit, head.find('>', unit) - unit);
  static const std::regex attribute(R"RE(\smeter\s*=\s*["']\s*([^"'\s]*)\s*["'])RE");
  std::smatch match;
  if (!std::regex_search(tag, match, attribute)) {
    return 1.0;
  }
  const std::string text = match[1].str();
  double metres = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), metres);
  if (error != std::errc() || rest != text.data() + text.size() || !std::isfinite(metres) || metres <= 0.0) {
    throw WorldError(fmt::format("<unit meter=\"{}\">: expected a number > 0", text));
  }
  return metres;
}

bool is_for_assimp(std::string_view extension) {
  return extension == "glb" || extension == "gltf" || extension == "fbx";
}

RawMesh read_raw(const MeshFileRequest& request, std::vector<std::string>& warnings) {
  const auto read = is_for_assimp(lower_extension(request.file)) ? read_with_assimp : read_with_osg;
  const IsolatedResult result = run_isolated([&] { return to_bytes(read(request.file, request.submesh)); },
                                             reading_limit_s(request.file));
  // The one remark of a plugin that costs an acoustic material: a name that no material library defines.
  static const std::regex lost_material(R"(unable to find material '([^']+)')");
  for (std::sregex_iterator it(result.log.begin(), result.log.end(), lost_material), end; it != end; ++it) {
    warnings.push_back(fmt::format("{}: material '{}' is used but no material library of the file defines it",
                                   request.file.string(), (*it)[1].str()));
  }
  return raw_mesh_of(result.bytes);
}

void drop_invented_normals(const std::filesystem::path& file, RawMesh& raw) {
  const std::string extension = lower_extension(file);
  // The normals of an STL say nothing that its triangles do not say, and many tools write zeros.
  if (extension == "stl" || (extension == "ply" && !ply_has_normals(file))) {
    for (RawPart& part : raw.parts) {
      part.normals.clear();
    }
  }
}

/// Middle of the box around all vertices that triangles use and that are numbers.
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

void require_parts(const RawMesh& raw, const MeshFileRequest& request) {
  std::size_t triangles = 0;
  for (const RawPart& part : raw.parts) {
    triangles += part.indices.size() / 3;
  }
  if (triangles > max_triangles) {
    throw WorldError(fmt::format("{} triangles are more than {}", triangles, max_triangles));
  }
  if (triangles == 0 && !request.submesh.empty()) {
    throw WorldError(fmt::format("no submesh '{}' with triangles; names in the file: {}", request.submesh,
                                 fmt::join(raw.names, ", ")));
  }
}

MeshFile load_checked(const MeshFileRequest& request) {
  MeshFile loaded;
  const std::string extension = lower_extension(request.file);
  if (extension == "stl") {
    check_binary_stl(request.file);
  } else if (extension == "ply") {
    check_text_ply(request.file);
  }
  const double unit_m = extension == "dae" ? collada_unit_m(request.file) : 1.0;
  RawMesh raw = read_raw(request, loaded.warnings);
  require_parts(raw, request);
  drop_invented_normals(request.file, raw);

  const glm::dvec3 origin = request.center_submesh ? box_centre(raw) : glm::dvec3(0.0);
  std::size_t triangles = 0;
  bool far = false;
  for (RawPart& part : raw.parts) {
    std::string material_name = part.material_name;
    TriangleMesh mesh =
        validated_mesh(scaled(std::move(part), origin, request.scale * unit_m), loaded.diagnostics);
    if (mesh.indices.empty()) {
      continue;
    }
    if (request.tangents) {
      if (mesh.texcoords.empty()) {
        throw WorldError("a normal map needs texture coordinates, the mesh has none");
      }
      add_tangents(mesh);
    }
    triangles += mesh.triangle_count();
    far = far || is_far(mesh);
    loaded.parts.push_back({std::move(material_name), std::make_shared<const TriangleMesh>(std::move(mesh))});
  }
  if (triangles == 0) {
    throw WorldError("the mesh has no triangles");
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
  require_local_file(request.file, mesh_extensions, "mesh");
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(request.scale[axis]) || request.scale[axis] == 0.0) {
      throw WorldError(fmt::format("{}: scale {} {} {}: expected finite numbers other than 0",
                                   request.file.string(), request.scale.x, request.scale.y, request.scale.z));
    }
  }
  try {
    return load_checked(request);
  } catch (const std::runtime_error& error) {
    throw WorldError(fmt::format("{}: {}", request.file.string(), error.what()));
  }
}

}  // namespace sonard::render
