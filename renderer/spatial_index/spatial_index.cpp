#include "renderer/visibility/embree_scene.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <type_traits>
#include <vector>

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include "renderer/errors.hpp"
#include "renderer/simd.hpp"
#include "renderer/visibility/mesh_cache.hpp"
#include "renderer/visibility/ray_shading.hpp"

namespace sonard::render {

namespace {

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
template <class T>
using Handle = std::unique_ptr<std::remove_pointer_t<T>, Release>;

using IntersectPacket = void (*)(const RayPacket&, RTCScene, RTCIntersectContext&, float max_depth, RayHits&);

/// Traces a packet as packet_size / N packets of Embree's type `RayHit` for N rays. Inlined, so that it
/// becomes part of each version of its caller.
template <class RayHit, int N, void (*intersect)(const int*, RTCScene, RTCIntersectContext*, RayHit*)>
[[gnu::always_inline]] inline void intersect_by(const RayPacket& rays, RTCScene scene,
                                                RTCIntersectContext& context, float max_depth,
                                                RayHits& hits) {
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
    intersect(valid.data(), scene, &context, &query);
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

SONARD_SIMD_CLONES void intersect_by_16(const RayPacket& rays, RTCScene scene, RTCIntersectContext& context,
                                        float max_depth, RayHits& hits) {
  intersect_by<RTCRayHit16, 16, &rtcIntersect16>(rays, scene, context, max_depth, hits);
}

SONARD_SIMD_CLONES void intersect_by_8(const RayPacket& rays, RTCScene scene, RTCIntersectContext& context,
                                       float max_depth, RayHits& hits) {
  intersect_by<RTCRayHit8, 8, &rtcIntersect8>(rays, scene, context, max_depth, hits);
}

void intersect_by_4(const RayPacket& rays, RTCScene scene, RTCIntersectContext& context, float max_depth,
                    RayHits& hits) {
  intersect_by<RTCRayHit4, 4, &rtcIntersect4>(rays, scene, context, max_depth, hits);
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

/// Lets rays pass through triangles that they meet from behind.
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

struct EmbreeScene::Impl {
  struct Mesh {
    std::shared_ptr<const TriangleMesh> triangles;  // Embree reads the indices in place
    Handle<RTCScene> scene;
  };
  struct Part {
    Handle<RTCGeometry> instance;
    std::shared_ptr<const Mesh> mesh;
    std::size_t body = 0;
    Pose T_body_part;
    SurfaceShader shader;
  };

  Handle<RTCDevice> device;
  IntersectPacket intersect = nullptr;
  std::string description;
  std::vector<Part> parts;
  MeshCache<std::shared_ptr<const Mesh>> replacements;
  std::map<std::size_t, std::shared_ptr<const TriangleMesh>> awaited;  // by part
  WorkerPool& workers;
  std::vector<Pose> T_world_body;
  Handle<RTCScene> scene;
  glm::dvec3 sonar_position_m{0.0};
  bool placed = false;

  Impl(const World& world, WorkerPool& pool, const std::string& settings) : workers(pool) {
    // Meshes are built side by side, each by one thread: the tree, and with it which of two triangles that
    // share an edge a ray on it meets, is then the same every time.
    device.reset(rtcNewDevice(("threads=1,ignore_config_files=1," + settings).c_str()));
    check("set up");
    choose_packets();
    build(add_world(world));
    add_instances();
  }

  /// @throws RendererError when Embree has met an error since the last call.
  void check(const char* action) const {
    const RTCError error = rtcGetDeviceError(device.get());
    if (error != RTC_ERROR_NONE || !device) {
      throw RendererError(fmt::format("Embree could not {}: {}", action,
                                      error == RTC_ERROR_OUT_OF_MEMORY ? "out of memory"
                                      : error == RTC_ERROR_UNSUPPORTED_CPU
                                          ? "it does not support this CPU"
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

  /// @return the meshes, each of which is yet to be built.
  std::vector<std::shared_ptr<const Mesh>> add_world(const World& world) {
    std::vector<std::shared_ptr<const Mesh>> meshes;
    std::map<const TriangleMesh*, std::size_t> mesh_index;
    std::map<const NormalMap*, std::shared_ptr<const NormalPyramid>> pyramids;
    for (const Body& body : world.bodies) {
      for (const BodyPart& part : body.parts) {
        const auto [entry, is_new] = mesh_index.try_emplace(part.mesh.get(), meshes.size());
        if (is_new) {
          meshes.push_back(new_mesh(part.mesh));
        }
        std::shared_ptr<const NormalPyramid>& pyramid = pyramids[part.normal_map.get()];
        if (part.normal_map && !pyramid) {
          pyramid = std::make_shared<const NormalPyramid>(*part.normal_map);
        }
        Handle<RTCGeometry> instance(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(instance.get(), meshes[entry->second]->scene.get());
        parts.push_back({std::move(instance), meshes[entry->second], T_world_body.size(), part.T_body_part,
                         SurfaceShader(part, pyramid)});
      }
      T_world_body.push_back(body.T_world_body);
    }
    return meshes;
  }

  /// Those that set_part_meshes() was told of.
  void replace_meshes() {
    std::vector<std::shared_ptr<const Mesh>> unknown;
    for (const auto& [number, triangles] : awaited) {
      const auto* known = replacements.find(triangles.get());
      if (known == nullptr) {
        unknown.push_back(new_mesh(triangles));
      }
      Part& part = parts[number];
      part.mesh = known != nullptr ? *known : unknown.back();
      rtcSetGeometryInstancedScene(part.instance.get(), part.mesh->scene.get());
      part.shader.set_mesh(triangles);
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
      return;  // check() tells
    }
    std::memcpy(vertices, triangles.positions.data(), triangles.positions.size() * sizeof(glm::vec3));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               triangles.indices.data(), 0, 3 * sizeof(std::uint32_t),
                               triangles.triangle_count());
    rtcCommitGeometry(geometry.get());
    rtcSetSceneFlags(mesh.scene.get(), RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcAttachGeometry(mesh.scene.get(), geometry.get());
    rtcCommitScene(mesh.scene.get());
  }

  void add_instances() {
    scene.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      rtcAttachGeometryByID(scene.get(), parts[i].instance.get(), static_cast<unsigned>(i));
    }
    check("place the meshes");
  }
};

EmbreeScene::EmbreeScene(const World& world, WorkerPool& workers, const std::string& embree_settings)
    : impl_(std::make_unique<Impl>(world, workers, embree_settings)) {}
EmbreeScene::~EmbreeScene() = default;

void EmbreeScene::set_body_pose(std::size_t body, const Pose& T_world_body) {
  Pose& pose = impl_->T_world_body[body];
  impl_->placed = impl_->placed && pose == T_world_body;
  pose = T_world_body;
}

void EmbreeScene::set_part_meshes(std::span<const PartMesh> changes) {
  for (const PartMesh& change : changes) {
    impl_->awaited[change.part] = change.mesh;
  }
  impl_->placed = impl_->placed && changes.empty();
}

void EmbreeScene::place(const glm::dvec3& sonar_position_m) {
  if (impl_->placed && sonar_position_m == impl_->sonar_position_m) {
    return;
  }
  impl_->placed = false;
  impl_->replace_meshes();
  for (Impl::Part& part : impl_->parts) {
    if (part.mesh->triangles->indices.empty()) {
      rtcDisableGeometry(part.instance.get());
      continue;
    }
    rtcEnableGeometry(part.instance.get());
    const Pose T_sonar_part =
        relative({sonar_position_m, {1, 0, 0, 0}}, impl_->T_world_body[part.body]) * part.T_body_part;
    part.shader.turn(T_sonar_part.orientation);
    const auto& [x, y, z] = part.shader.axes();
    const std::array<glm::vec3, 4> columns{x, y, z, glm::vec3(T_sonar_part.position_m)};
    static_assert(sizeof(columns) == 12 * sizeof(float));
    rtcSetGeometryTransform(part.instance.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
    rtcCommitGeometry(part.instance.get());
  }
  rtcCommitScene(impl_->scene.get());
  impl_->check("place the sonar");
  impl_->sonar_position_m = sonar_position_m;
  impl_->placed = true;
}

SONARD_SIMD_CLONES void EmbreeScene::trace(const RayPacket& rays, const SurfaceModel& model, float max_depth,
                                           SurfacePacket& surfaces) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  context.filter = model.two_sided ? nullptr : &pass_back_faces;
  RayHits hits;
  impl_->intersect(rays, impl_->scene.get(), context, max_depth, hits);
  for (std::size_t i = 0; i < packet_size; ++i) {
    surfaces.depth[i] = hits.part[i] != no_part ? hits.depth[i] : 0.0F;
  }
  surfaces.part = hits.part;
  surfaces.triangle = hits.triangle;
  // Neighbours mostly meet the same part: one round shades them all.
  Lanes<std::uint32_t> waiting = hits.part;
  while (true) {
    std::uint32_t part = no_part;  // the greatest number, so what is left of the smallest is a part
    for (std::size_t i = 0; i < packet_size; ++i) {
      part = std::min(part, waiting[i]);
    }
    if (part == no_part) {
      return;
    }
    impl_->parts[part].shader.shade(rays, hits, part, model, surfaces);
    for (std::size_t i = 0; i < packet_size; ++i) {
      waiting[i] = waiting[i] == part ? no_part : waiting[i];
    }
  }
}

bool EmbreeScene::trace_one(const glm::vec3& origin_m, const glm::vec3& direction, float farthest_m,
                            SurfaceHit& hit) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray = ray_of(origin_m, direction, farthest_m);
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    return false;
  }
  const auto& [x, y, z] = impl_->parts[query.hit.instID[0]].shader.axes();
  hit.distance_m = query.ray.tfar;
  hit.normal = x * query.hit.Ng_x + y * query.hit.Ng_y + z * query.hit.Ng_z;
  hit.part = query.hit.instID[0];
  hit.triangle = query.hit.primID;
  return true;
}

void EmbreeScene::trace_plainly(const RayPacket& rays, float farthest_m,
                                std::array<SurfaceHit, packet_size>& hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  RayHits found;
  impl_->intersect(rays, impl_->scene.get(), context, farthest_m, found);
  for (std::size_t i = 0; i < packet_size; ++i) {
    hits[i] = {};
    if (found.part[i] != no_part) {
      const auto& [x, y, z] = impl_->parts[found.part[i]].shader.axes();
      hits[i] = {found.depth[i], x * found.normal_x[i] + y * found.normal_y[i] + z * found.normal_z[i],
                 found.part[i], found.triangle[i]};
    }
  }
}

bool EmbreeScene::is_free(const glm::vec3& origin_m, const glm::vec3& direction, float distance_m) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = ray_of(origin_m, direction, distance_m);
  rtcOccluded1(impl_->scene.get(), &context, &ray);
  return ray.tfar >= 0;  // minus infinity where something was met
}

const std::string& EmbreeScene::description() const {
  return impl_->description;
}

}  // namespace sonard::render
