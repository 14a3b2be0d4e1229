// SPDX-License-Identifier: Apache-2.0
// The buffers of a ping on the GPU, which the stages of slices hand on. Their records are in records.glsl.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "renderer/engines/gpu/gpu_buffer.hpp"
#include "renderer/engines/gpu/gpu_readback.hpp"
#include "renderer/engines/gpu/records.hpp"

namespace sonard::render {

using GpuSlice = records::Slice;
using GpuVisible = records::Visible;
using GpuTriangle = records::FanTriangle;
using records::PingCounts;

/// One ping in flight. Each stage binds the buffers that its shaders use.
struct PingBuffers {
  explicit PingBuffers(osg::GLExtensions& on) : gl(on) {}

  osg::GLExtensions& gl;
  /// At first 65 MB, which is enough for most pings.
  records::Room room{1U << 17U, 1U << 18U, 1U << 18U, 1U << 20U, 1U << 12U, 1U << 19U, 1U << 14U, 1U << 14U};
  GpuBuffer ping{gl};                         ///< the uniform block
  GpuBuffer parts{gl}, hiding{gl};            ///< poses of parts, and which of their shells hide inner sides
  GpuBuffer fan{gl};                          ///< GpuTriangle
  GpuBuffer counts{gl};                       ///< PingCounts, and the rounds of refinement
  GpuBuffer beams{gl}, lists{gl};             ///< triangles of each beam
  GpuBuffer slices{gl};                       ///< GpuSlice
  GpuBuffer visible{gl};                      ///< GpuVisible, slice after slice
  GpuBuffer scratch{gl};                      ///< of see.comp
  GpuBuffer sides{gl};                        ///< of each slice, port and starboard: 1 / h at the probes
  GpuBuffer things{gl}, ends{gl}, edges{gl};  ///< of each beam: see things.comp
  GpuBuffer order{gl};  ///< slices of each beam from port to starboard, by parity of the round
  // Of GpuEchoes:
  GpuBuffer echo{gl};                          ///< the uniform block
  GpuBuffer surfaces{gl}, solid_angles{gl};    ///< of parts; of beams
  GpuBuffer pieces_of_slices{gl}, pieces{gl};  ///< parts of visible segments, later their patches
  GpuBuffer sums{gl}, image{gl};               ///< of bin.comp and sums.comp
  GpuReadback result{gl};                      ///< counts and image
  PingCounts counted{};                        ///< of the last GpuEchoes::take()

  /// Makes room for twice what a ping needed: what came after a full buffer could not be counted.
  /// @return false: all buffers were large enough
  bool grow(const records::Room& needed_room) {
    using Numbers = std::array<std::uint32_t, sizeof(records::Room) / sizeof(std::uint32_t)>;
    const auto needed = std::bit_cast<Numbers>(needed_room), had = std::bit_cast<Numbers>(room);
    Numbers numbers = had;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const std::uint64_t twice = std::min(std::uint64_t{2} * needed[i], std::uint64_t{~std::uint32_t{0}});
      numbers[i] = needed[i] > had[i] ? static_cast<std::uint32_t>(twice) : had[i];
    }
    room = std::bit_cast<records::Room>(numbers);
    return numbers != had;
  }
};

}  // namespace sonard::render
