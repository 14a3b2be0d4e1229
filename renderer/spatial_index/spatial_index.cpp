// SPDX-License-Identifier: Apache-2.0
#include "renderer/spatial_index/spatial_index.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "renderer/errors.hpp"
#include "renderer/sampling.hpp"
#include "renderer/scene/mesh_cache.hpp"
#include "renderer/simd.hpp"
#include "renderer/spatial_index/embree.hpp"

namespace sonard::render {

namespace {

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
template <class T>
using Handle = std::unique_ptr<std::remove_pointer_t<T>, Release>;

using IntersectPacket = void (*)(const RayPacket&, RTCScene, embree::Query&, float max_depth, RayHits&);

/// Traces a packet as packet_size / N packets of Embree's type `RayHit` for N rays. Always inlined, to be
/// compiled for each version of its caller (renderer/simd.hpp).
template <class RayHit, int N>
[[gnu::always_inline]] inline void intersect_by(const RayPacket& rays, RTCScene scene, embree::Query& by,
                                                float max_depth, RayHits& hits) {
  alignas(64) std::array<int, N> valid;
  valid.fill(-1);
  for (std::size_t first = 0; first < packet_size; first += N) {
    RayHit query;
    for (std::size_t i = 0; i < N; ++i) {
      query.ray.org_x[i] = query.ray.org_y[i] = query.ray.org_z[i] = 0.0F;
      query.ray.tnear[i] = nearest_depth_m;
      query.ray.dir_x[i] = rays.x[first + i];
      query.ray.dir_y[i] = rays.y[first + i];
      query.ray.dir_z[i] = rays.z[first + i];
      query.ray.time[i] = 0.0F;
      query.ray.tfar[i] = max_depth;
      query.ray.mask[i] = ~0U;
      query.ray.id[i] = query.ray.flags[i] = 0;
      query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      query.hit.Ng_x[i] = query.hit.Ng_y[i] = query.hit.Ng_z[i] = 0.0F;
      query.hit.u[i] = query.hit.v[i] = 0.0F;
      query.hit.primID[i] = 0;
    }
    embree::intersect(valid.data(), scene, by, query);
    std::copy_n(query.ray.tfar, N, hits.depth.begin() + first);
    std::copy_n(query.hit.Ng_x, N, hits.normal_x.begin() + first);
    std::copy_n(query.hit.Ng_y, N, hits.normal_y.begin() + first);
    std::copy_n(query.hit.Ng_z, N, hits.normal_z.begin() + first);
    std::copy_n(query.hit.u, N, hits.u.begin() + first);
    std::copy_n(query.hit.v, N, hits.v.begin() + first);
    std::copy_n(query.hit.primID, N, hits.triangle.begin() + first);
    std::copy_n(query.hit.instID[0], N, hits.part.begin() + first);
  }
}

SONARD_SIMD_CLONES void intersect_by_16(const RayPacket& rays, RTCScene scene, embree::Query& by,
                                        float max_depth, RayHits& hits) {
  intersect_by<RTCRayHit16, 16>(rays, scene, by, max_depth, hits);
}

SONARD_SIMD_CLONES void intersect_by_8(const RayPacket& rays, RTCScene scene, embree::Query& by,
                                       float max_depth, RayHits& hits) {
  intersect_by<RTCRayHit8, 8>(rays, scene, by, max_depth, hits);
}

void intersect_by_4(const RayPacket& rays, RTCScene scene, embree::Query& by, float max_depth,
                    RayHits& hits) {
  intersect_by<RTCRayHit4, 4>(rays, scene, by, max_depth, hits);
}

RTCRay ray_of(const glm::vec3& origin_m, const glm::vec3& direction, float farthest_m) {
  RTCRay ray{};
  ray.org_x = origin_m.x;
  ray.org_y = origin_m.y;
  ray.org_z = origin_m.z;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tfar = farthest_m;
  ray.mask = ~0U;
  return ray;
}

/// Filter that drops hits on the back of triangles.
void pass_back_faces(const RTCFilterFunctionNArguments* arguments) {
  for (unsigned i = 0; i < arguments->N; ++i) {
    const float facing =
        RTCRayN_dir_x(arguments->ray, arguments->N, i) * RTCHitN_Ng_x(arguments->hit, arguments->N, i) +
        RTCRayN_dir_y(arguments->ray, arguments->N, i) * RTCHitN_Ng_y(arguments->hit, arguments->N, i) +
        RTCRayN_dir_z(arguments->ray, arguments->N, i) * RTCHitN_Ng_z(arguments->hit, arguments->N, i);
    if (facing >= 0) {
      arguments->valid[i] = 0;
    }
  }
}

}  // namespace

static_assert(no_part == RTC_INVALID_GEOMETRY_ID);

struct SpatialIndex::Impl {
  struct Mesh {
    std::shared_ptr<const TriangleMesh> triangles;  // Embree reads the indices in place
    Handle<RTCScene> scene;
  };
  struct Part {
    Handle<RTCGeometry> instance;
    std::shared_ptr<const Mesh> mesh;
    std::size_t body = 0;
    Pose T_body_part;
    std::array<glm::vec3, 3> axes{};
  };

  World world;
  WorkerPool& workers;
  Handle<RTCDevice> device;
  IntersectPacket intersect = nullptr;
  std::string description;
  std::vector<Part> parts;
  MeshCache<std::shared_ptr<const Mesh>> replacements;
  std::map<std::size_t, std::shared_ptr<const TriangleMesh>> awaited;  // by part
  Handle<RTCScene> scene;                                              // null: not yet built
  glm::dvec3 sonar_position_m{0.0};
  bool placed = false;

  Impl(World the_world, WorkerPool& pool, const std::string& settings)
      : world(std::move(the_world)), workers(pool) {
    // Meshes are built in parallel, each by one thread. The tree is then the same every time, and so is the
    // result for rays that hit an edge between two triangles.
    device.reset(rtcNewDevice(("threads=1,ignore_config_files=1," + settings).c_str()));
    check("set up");
    choose_packets();
  }

  /// @throws RendererError if Embree had an error since the last call; std::bad_alloc if it ran out of memory
  void check(const char* action) const {
    const RTCError error = rtcGetDeviceError(device.get());
    if (error == RTC_ERROR_OUT_OF_MEMORY) {
      throw std::bad_alloc();
    }
    if (error != RTC_ERROR_NONE || !device) {
      throw RendererError(fmt::format("Embree could not {}: {}", action,
                                      error == RTC_ERROR_UNSUPPORTED_CPU ? "it does not support this CPU"
                                                                         : "error " + std::to_string(error)));
    }
  }

  void choose_packets() {
    int width = 4;
    intersect = &intersect_by_4;
    if (rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0) {
      width = 16;
      intersect = &intersect_by_16;
    } else if (rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0) {
      width = 8;
      intersect = &intersect_by_8;
    }
    const auto version = [&](RTCDeviceProperty part) { return rtcGetDeviceProperty(device.get(), part); };
    description = fmt::format("Embree {}.{}.{}, packets of {}", version(RTC_DEVICE_PROPERTY_VERSION_MAJOR),
                              version(RTC_DEVICE_PROPERTY_VERSION_MINOR),
                              version(RTC_DEVICE_PROPERTY_VERSION_PATCH), width);
  }

  std::shared_ptr<const Mesh> new_mesh(const std::shared_ptr<const TriangleMesh>& triangles) const {
    return std::make_shared<const Mesh>(Mesh{triangles, Handle<RTCScene>(rtcNewScene(device.get()))});
  }

  void build() {
    parts.clear();
    build(add_parts());
    add_instances();
  }

  /// @return the meshes, not built yet.
  std::vector<std::shared_ptr<const Mesh>> add_parts() {
    std::vector<std::shared_ptr<const Mesh>> meshes;
    std::map<const TriangleMesh*, std::size_t> mesh_index;
    for (std::size_t body = 0; body < world.bodies.size(); ++body) {
      for (const BodyPart& part : world.bodies[body].parts) {
        const auto [entry, is_new] = mesh_index.try_emplace(part.mesh.get(), meshes.size());
        if (is_new) {
          meshes.push_back(new_mesh(part.mesh));
        }
        Handle<RTCGeometry> instance(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(instance.get(), meshes[entry->second]->scene.get());
        parts.push_back({std::move(instance), meshes[entry->second], body, part.T_body_part});
      }
    }
    return meshes;
  }

  /// Applies the meshes passed to set_part_meshes().
  void replace_awaited() {
    std::vector<std::shared_ptr<const Mesh>> unknown;
    for (const auto& [number, triangles] : awaited) {
      const auto* known = replacements.find(triangles.get());
      if (known == nullptr) {
        unknown.push_back(new_mesh(triangles));
      }
      Part& part = parts[number];
      part.mesh = known != nullptr ? *known : unknown.back();
      rtcSetGeometryInstancedScene(part.instance.get(), part.mesh->scene.get());
    }
    awaited.clear();
    build(unknown);
    for (const auto& mesh : unknown) {
      replacements.keep(mesh->triangles, mesh);
    }
  }

  void build(const std::vector<std::shared_ptr<const Mesh>>& meshes) const {
    workers.run(static_cast<int>(meshes.size()), [&](int i) { build(*meshes[static_cast<std::size_t>(i)]); });
    check("build the meshes");
  }

  void build(const Mesh& mesh) const {
    const TriangleMesh& triangles = *mesh.triangles;
    if (triangles.indices.empty()) {
      rtcCommitScene(mesh.scene.get());
      return;
    }
    const Handle<RTCGeometry> geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    // A copy, because Embree reads beyond the last vertex.
    void* vertices =
        rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(glm::vec3), std::max<std::size_t>(1, triangles.positions.size()));
    if (vertices == nullptr) {
      return;  // check() reports it
    }
    std::memcpy(vertices, triangles.positions.data(), triangles.positions.size() * sizeof(glm::vec3));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               triangles.indices.data(), 0, 3 * sizeof(std::uint32_t),
                               triangles.triangle_count());
    rtcCommitGeometry(geometry.get());
    rtcSetSceneFlags(mesh.scene.get(), embree::filter_of_query);
    rtcAttachGeometry(mesh.scene.get(), geometry.get());
    rtcCommitScene(mesh.scene.get());
  }

  void add_instances() {
    scene.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(scene.get(), embree::filter_of_query);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      rtcAttachGeometryByID(scene.get(), parts[i].instance.get(), static_cast<unsigned>(i));
    }
    check("place the meshes");
  }
};

SpatialIndex::SpatialIndex(World world, WorkerPool& workers, const std::string& embree_settings)
    : impl_(std::make_unique<Impl>(std::move(world), workers, embree_settings)) {}
SpatialIndex::~SpatialIndex() = default;

const World& SpatialIndex::world() const {
  return impl_->world;
}

bool SpatialIndex::is_built() const {
  return impl_->scene != nullptr;
}

const std::array<glm::vec3, 3>& SpatialIndex::axes(std::size_t part) const {
  return impl_->parts[part].axes;
}

void SpatialIndex::set_body_pose(std::size_t body, const Pose& T_world_body) {
  Pose& pose = impl_->world.bodies[body].T_world_body;
  impl_->placed = impl_->placed && pose == T_world_body;
  pose = T_world_body;
}

void SpatialIndex::set_part_meshes(std::span<const PartMesh> changes) {
  replace_meshes(impl_->world, changes);
  impl_->placed = impl_->placed && changes.empty();
  if (is_built()) {
    for (const PartMesh& change : changes) {
      impl_->awaited[change.part] = change.mesh;
    }
  }
}

void SpatialIndex::place(const glm::dvec3& sonar_position_m) {
  if (impl_->placed && sonar_position_m == impl_->sonar_position_m) {
    return;
  }
  impl_->placed = false;
  if (!is_built()) {
    impl_->build();
  }
  impl_->replace_awaited();
  for (Impl::Part& part : impl_->parts) {
    if (part.mesh->triangles->indices.empty()) {
      rtcDisableGeometry(part.instance.get());
      continue;
    }
    rtcEnableGeometry(part.instance.get());
    const Pose T_sonar_part =
        relative({sonar_position_m, {1, 0, 0, 0}}, impl_->world.bodies[part.body].T_world_body) *
        part.T_body_part;
    const glm::dquat& turn = T_sonar_part.orientation;
    part.axes = {glm::vec3(turn * glm::dvec3(1, 0, 0)), glm::vec3(turn * glm::dvec3(0, 1, 0)),
                 glm::vec3(turn * glm::dvec3(0, 0, 1))};
    const std::array<glm::vec3, 4> columns{part.axes[0], part.axes[1], part.axes[2],
                                           glm::vec3(T_sonar_part.position_m)};
    static_assert(sizeof(columns) == 12 * sizeof(float));
    rtcSetGeometryTransform(part.instance.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
    rtcCommitGeometry(part.instance.get());
  }
  rtcCommitScene(impl_->scene.get());
  impl_->check("place the sonar");
  impl_->sonar_position_m = sonar_position_m;
  impl_->placed = true;
}

void SpatialIndex::trace(const RayPacket& rays, float max_depth, bool back_faces, RayHits& hits) const {
  embree::Query query;
  query.coherent(back_faces ? nullptr : &pass_back_faces);
  impl_->intersect(rays, impl_->scene.get(), query, max_depth, hits);
}

void SpatialIndex::trace(const RayPacket& rays, float farthest_m,
                         std::array<SurfaceHit, packet_size>& hits) const {
  RayHits found;
  trace(rays, farthest_m, true, found);
  for (std::size_t i = 0; i < packet_size; ++i) {
    hits[i] = {};
    if (found.part[i] != no_part) {
      const auto& [x, y, z] = impl_->parts[found.part[i]].axes;
      hits[i] = {found.depth[i], x * found.normal_x[i] + y * found.normal_y[i] + z * found.normal_z[i],
                 found.part[i], found.triangle[i]};
    }
  }
}

bool SpatialIndex::trace_one(const glm::vec3& origin_m, const glm::vec3& direction, float farthest_m,
                             SurfaceHit& hit) const {
  RTCRayHit query{};
  query.ray = ray_of(origin_m, direction, farthest_m);
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree::intersect(impl_->scene.get(), query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    return false;
  }
  const auto& [x, y, z] = impl_->parts[query.hit.instID[0]].axes;
  hit.distance_m = query.ray.tfar;
  hit.normal = x * query.hit.Ng_x + y * query.hit.Ng_y + z * query.hit.Ng_z;
  hit.part = query.hit.instID[0];
  hit.triangle = query.hit.primID;
  return true;
}

bool SpatialIndex::is_free(const glm::vec3& origin_m, const glm::vec3& direction, float distance_m) const {
  RTCRay ray = ray_of(origin_m, direction, distance_m);
  embree::occluded(impl_->scene.get(), ray);
  return ray.tfar >= 0;  // minus infinity if the ray hit something
}

const std::string& SpatialIndex::description() const {
  return impl_->description;
}

}  // namespace sonard::render
