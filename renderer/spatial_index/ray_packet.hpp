// Sixteen rays at a time: what goes into a trace and what comes out, lane by lane.
#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

namespace sonard::render {

/// Rays of one packet: a patch of 4 x 4 neighbours, row after row, because rays that stay together share the
/// work of walking the tree. CPUs without 512-bit vectors trace it as two patches of 4 x 2 or four rows.
inline constexpr int packet_side = 4;
inline constexpr int packet_size = packet_side * packet_side;

template <class T>
using Lanes = std::array<T, packet_size>;

/// Rays q from the sonar, in world axes; they need no unit length.
struct alignas(64) RayPacket {
  Lanes<float> x, y, z;
  /// What q changes by from one sample to the next along the two directions of the grid: the area over which
  /// a normal map is averaged.
  glm::vec3 step_x{0.0F}, step_y{0.0F};
};

/// What the rays of a packet meet. The surface point of a lane is depth * q. Where depth is 0 the rest is
/// without meaning.
struct alignas(64) SurfacePacket {
  Lanes<float> depth;  ///< 0: nothing up to the depth asked for
  /// Geometric normal in world axes, neither of unit length nor turned towards the sonar.
  Lanes<float> normal_x, normal_y, normal_z;
  Lanes<float> response;          ///< as SurfaceSample::response; may be not a number
  Lanes<std::uint32_t> part;      ///< counts the parts of all bodies in the order of the world
  Lanes<std::uint32_t> triangle;  ///< of the part's mesh
};

inline constexpr std::uint32_t no_part = ~std::uint32_t{0};

/// The hits of a packet before shading.
struct alignas(64) RayHits {
  Lanes<float> depth;
  Lanes<float> normal_x, normal_y, normal_z;  ///< geometric, in the frame of the part, not of unit length
  Lanes<float> u, v;                          ///< of the triangle's second and third corner
  Lanes<std::uint32_t> triangle;
  Lanes<std::uint32_t> part;  ///< no_part: nothing was hit
};

}  // namespace sonard::render
