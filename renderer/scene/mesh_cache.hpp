// SPDX-License-Identifier: Apache-2.0
// Cache of data that an engine builds from meshes.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <unordered_map>
#include <utility>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Sonars that share a renderer draw a terrain in turn, in different detail. The cache keeps the data of one
/// sonar until its next turn. Beyond `most_triangles`, it drops the data with the oldest use.
template <class Built>
class MeshCache {
 public:
  static constexpr std::size_t most_triangles = 4'000'000;

  /// nullptr if there is no entry. The entry counts as used.
  Built* find(const TriangleMesh* mesh) {
    const auto known = places_.find(mesh);
    if (known == places_.end()) {
      return nullptr;
    }
    entries_.splice(entries_.begin(), entries_, known->second);
    return &known->second->second;
  }

  /// Does nothing if there is an entry for the mesh.
  void keep(const std::shared_ptr<const TriangleMesh>& mesh, Built built) {
    if (places_.count(mesh.get()) != 0) {
      return;
    }
    entries_.emplace_front(mesh, std::move(built));
    places_[mesh.get()] = entries_.begin();
    triangles_ += mesh->triangle_count();
    while (triangles_ > most_triangles && entries_.size() > 1) {
      triangles_ -= entries_.back().first->triangle_count();
      places_.erase(entries_.back().first.get());
      entries_.pop_back();
    }
  }

 private:
  using Entry = std::pair<std::shared_ptr<const TriangleMesh>, Built>;
  std::list<Entry> entries_;  ///< most recent use first
  std::unordered_map<const TriangleMesh*, typename std::list<Entry>::iterator> places_;
  std::size_t triangles_ = 0;
};

}  // namespace sonard::render
