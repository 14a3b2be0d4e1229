// SPDX-License-Identifier: Apache-2.0
// Packets of sixteen rays: input and output of a search, lane by lane.
#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

namespace sonard::render {

/// Rays of one packet: a patch of 4 x 4 neighbours, row by row, because neighbouring rays share the work of
/// traversing the tree. CPUs without 512-bit vectors trace it as two patches of 4 x 2 or as four rows.
inline constexpr int packet_side = 4;
inline constexpr int packet_size = packet_side * packet_side;

template <class T>
using Lanes = std::array<T, packet_size>;

/// Rays q from the sonar, in world axes; any length.
struct alignas(64) RayPacket {
  Lanes<float> x, y, z;
  /// Change of q from one sample to the next along the two directions of the grid: the area over which a
  /// normal map is averaged.
  glm::vec3 step_x{0.0F}, step_y{0.0F};
};

inline constexpr std::uint32_t no_part = ~std::uint32_t{0};

/// The first hits of a packet: the hit point of a lane is depth * q.
struct alignas(64) RayHits {
  Lanes<float> depth;
  Lanes<float> normal_x, normal_y, normal_z;  ///< geometric, in the frame of the part, not of unit length
  Lanes<float> u, v;                          ///< barycentric, of the triangle's second and third corner
  Lanes<std::uint32_t> triangle;
  /// Counts the parts of all bodies in the order of the world; no_part: no hit.
  Lanes<std::uint32_t> part;
};

}  // namespace sonard::render
