// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_surfaces.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <utility>

namespace sonard::render {

namespace {

std::uint32_t word(float number) {
  return std::bit_cast<std::uint32_t>(number);
}

std::uint32_t word(std::size_t number) {
  return static_cast<std::uint32_t>(number);
}

}  // namespace

/// Meshes and normal maps, one behind the other, each once.
class GpuSurfaces::Words {
 public:
  std::vector<std::uint32_t> words;

  /// @param mapped with texture coordinates and tangents
  void add_mesh(const TriangleMesh& mesh, bool mapped, records::Surface& record) {
    const auto [known, is_new] = meshes_.try_emplace({&mesh, mapped}, words.size());
    record.indices = word(known->second);
    record.vertices = word(known->second + mesh.indices.size());
    record.floats_per_vertex = mapped ? 9 : 3;
    if (!is_new) {
      return;
    }
    words.insert(words.end(), mesh.indices.begin(), mesh.indices.end());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const glm::vec3& n = mesh.normals[v];
      words.insert(words.end(), {word(n.x), word(n.y), word(n.z)});
      if (mapped) {
        const glm::vec2& uv = mesh.texcoords[v];
        const glm::vec4& t = mesh.tangents[v];
        words.insert(words.end(), {word(uv.x), word(uv.y), word(t.x), word(t.y), word(t.z), word(t.w)});
      }
    }
  }

  void add_map(const NormalPyramid& map, records::Surface& record) {
    const auto [known, is_new] = maps_.try_emplace(&map, words.size());
    record.levels = word(known->second);
    record.level_count = word(map.levels.size());
    if (!is_new) {
      return;
    }
    const std::size_t texels = words.size() + 3 * map.levels.size();
    for (const auto& [width_px, height_px, first_texel] : map.levels) {
      words.insert(words.end(), {static_cast<std::uint32_t>(width_px), static_cast<std::uint32_t>(height_px),
                                 word(texels + 2 * first_texel)});
    }
    words.resize(texels + 2 * map.texels.size());
    std::memcpy(&words[texels], map.texels.data(), map.texels.size() * sizeof(NormalPyramid::Texel));
  }

 private:
  std::map<std::pair<const TriangleMesh*, bool>, std::size_t> meshes_;
  std::map<const NormalPyramid*, std::size_t> maps_;
};

void GpuSurfaces::hold(const std::vector<PartSurface>& surfaces, std::size_t version,
                       const std::vector<bool>& may_be_seen) {
  if (version == version_ && may_be_seen == held_) {
    return;
  }
  version_ = version;
  held_ = may_be_seen;
  records_.clear();
  any_shaded_ = any_mapped_ = any_facets_ = false;
  Words world;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const PartSurface& part = surfaces[i];
    const Backscatter& backscatter = part.backscatter;
    const bool is_mapped = part.normal_map != nullptr;
    const bool is_shaded = part.vertex_normals && !part.mesh->normals.empty();
    records::Surface record{};
    record.lambert_mu = backscatter.lambert_mu;
    record.reflectance = part.reflectance;
    record.facet_strength = backscatter.facet_strength;
    record.slope_variance = std::min(backscatter.slope_variance, Backscatter::widest_variance);
    record.least_cosine = backscatter.least_cosine;
    record.flags = (is_shaded ? records::has_vertex_normals : 0) | (is_mapped ? records::has_map : 0);
    if (may_be_seen[i] && (is_shaded || is_mapped)) {
      world.add_mesh(*part.mesh, is_mapped, record);
    }
    if (may_be_seen[i] && is_mapped) {
      world.add_map(*part.normal_map, record);
    }
    any_shaded_ |= is_shaded;
    any_mapped_ |= is_mapped;
    any_facets_ |= backscatter.facet_strength > 0;
    records_.push_back(record);
  }
  world.words.push_back(0);  // a buffer must not be empty
  world_.fill(world.words);
}

void GpuSurfaces::upload(const std::vector<PartSurface>& surfaces, GpuBuffer& to) const {
  std::vector<records::Surface> placed = records_;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    for (int k = 0; k < 9; ++k) {
      placed[i].rotation[k] =
          surfaces[i].R_part_sonar[k / 3][k % 3];  // its columns are the rows of the inverse
    }
  }
  placed.emplace_back();  // a buffer must not be empty
  to.fill(placed, GL_STREAM_DRAW);
}

}  // namespace sonard::render
