// SPDX-License-Identifier: Apache-2.0
// If memory runs out at any allocation of a ping, that ping fails and leaves no trace in the next ones.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/ping.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "renderer/scene/world.hpp"

namespace {

constexpr std::size_t large_bytes = 64;  // smaller allocations always succeed
std::atomic<long> large_ones_left{-1};   // -1: any number; the one after these fails

// Not inlined: the compiler would take the pair of new and delete below for a pair of new and free.
[[gnu::noinline]] void* allocate(std::size_t size, std::size_t alignment) {
  if (size >= large_bytes && large_ones_left >= 0 && large_ones_left-- == 0) {
    throw std::bad_alloc();
  }
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  void* const memory = std::aligned_alloc(alignment, whole > 0 ? whole : alignment);
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}

[[gnu::noinline]] void release(void* memory) {
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) {
  return allocate(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
// The library's sorting uses this form and works without the memory if it gets none. AddressSanitizer has its
// own form, whose memory the operator delete below must not receive.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return allocate(size, alignof(std::max_align_t));
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* memory) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  release(memory);
}

namespace sonard::render {
namespace {

World wall() {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->positions = {{2.5F, 4, -4}, {2.5F, 4, 4}, {2.5F, -4, 4}, {2.5F, -4, -4}};
  mesh->indices = {0, 1, 2, 0, 2, 3};
  World world;
  Body& body = world.bodies.emplace_back();
  body.name = "wall";
  body.parts.push_back({mesh, {}, {}, nullptr});
  return world;
}

PingRequest ping(int lines, std::uint64_t number) {
  PingRequest request;
  request.ping_number = number;
  request.seed = 5;
  constexpr int beams = 16;
  for (int edge = 0; edge <= beams; ++edge) {
    request.settings.aperture.beam_edges_rad.push_back(0.8 - 1.6 * edge / beams);
  }
  request.settings.model = Model::physical;
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::ou;
  request.settings.physical.speckle.texture_nu = 3.0;
  request.settings.range.count = lines;
  request.settings.range.step_m = 0.01;
  return request;
}

/// Images of two pings for comparison: a long ping of head 0 and a short ping of head 1.
std::pair<std::vector<std::uint8_t>, std::vector<std::uint8_t>> images(SonarRenderer& renderer) {
  auto first = renderer.render_ping(ping(160, 7), 0).u8;
  return {std::move(first), renderer.render_ping(ping(80, 8), 1).u8};
}

TEST(LackOfMemory, FailsOnePingAndLeavesNoTrace) {
  const World world = wall();
  const RendererOptions options{EngineKind::cpu, 2};
  SonarRenderer fresh(world, options);
  const auto expected = images(fresh);
  long failed = 0;
  for (bool out = true; out; ++failed) {
    SonarRenderer renderer(world, options);
    large_ones_left = failed;
    try {
      renderer.render_ping(ping(160, 1), 0);
      out = false;
    } catch (const std::bad_alloc&) {
    }
    large_ones_left = -1;
    if (out) {
      renderer.forget(0);
      ASSERT_EQ(images(renderer), expected) << "after allocation " << failed << " had failed";
    }
  }
  EXPECT_GT(failed, 20) << "this test means something";
}

TEST(LackOfMemory, FailsALongerPingThanTheLastOneOnly) {
  const World world = wall();
  const RendererOptions options{EngineKind::cpu, 2};
  SonarRenderer fresh(world, options);
  const auto expected = images(fresh);
  for (long number = 0;; ++number) {
    SonarRenderer renderer(world, options);
    renderer.render_ping(ping(40, 0), 0);
    large_ones_left = number;
    try {
      renderer.render_ping(ping(160, 1), 0);
      break;
    } catch (const std::bad_alloc&) {
      large_ones_left = -1;
    }
    renderer.forget(0);
    ASSERT_EQ(images(renderer), expected) << "after allocation " << number << " had failed";
  }
  large_ones_left = -1;
}

}  // namespace
}  // namespace sonard::render
