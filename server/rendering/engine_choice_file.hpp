// SPDX-License-Identifier: Apache-2.0
// What `engine: auto` measured at an earlier start of the same heads on the same machine.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::server {

struct KeptChoice {
  render::EngineKind taken = render::EngineKind::cpu;
  std::string measured;  ///< a line: both times and what they were measured on
};

/// A text file of one line a choice; an empty path: none. It only saves time: a file that cannot be read, or
/// a line that makes no sense, counts as nothing known; one that cannot be written is not. Several daemons
/// may share it.
class EngineChoiceFile {
 public:
  explicit EngineChoiceFile(std::filesystem::path file) : file_(std::move(file)) {}

  const std::filesystem::path& path() const { return file_; }
  std::optional<KeptChoice> find(const std::string& situation) const;
  /// Replaces what was known of the same situation; the oldest of many lines goes.
  void keep(const std::string& situation, const KeptChoice& choice) const;

 private:
  std::filesystem::path file_;
};

/// sonard/engine_choices under $XDG_CACHE_HOME or ~/.cache; empty where the environment names neither.
std::filesystem::path engine_choice_path();

/// All that decides which engine is faster, as one line: this program, the processor, the devices and drivers
/// for OpenGL, the options, the size of the world and of the pings.
std::string situation_of(const render::RendererOptions& options, const render::World& world,
                         std::span<const render::StreamPing> first_pings);

}  // namespace sonard::server
