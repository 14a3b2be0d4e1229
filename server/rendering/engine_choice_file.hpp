// SPDX-License-Identifier: Apache-2.0
// Results that `engine: auto` measured at an earlier start with the same heads on the same machine.
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
  std::string measured;  ///< one line: both times and the machine
};

/// A text file with one line per choice; an empty path means no file. It only saves time: an unreadable file
/// or line counts as unknown, and a file that cannot be written is not written. Several daemons may share it.
class EngineChoiceFile {
 public:
  explicit EngineChoiceFile(std::filesystem::path file) : file_(std::move(file)) {}

  const std::filesystem::path& path() const { return file_; }
  std::optional<KeptChoice> find(const std::string& situation) const;
  /// Replaces the choice of the same situation; drops the oldest line if there are too many.
  void keep(const std::string& situation, const KeptChoice& choice) const;

 private:
  std::filesystem::path file_;
};

/// sonard/engine_choices in $XDG_CACHE_HOME or ~/.cache; empty if neither variable is set.
std::filesystem::path engine_choice_path();

/// Everything that decides which engine is faster, as one line: this program, the processor, the OpenGL
/// devices and drivers, the options, the world's name and size, and the size of the pings.
std::string situation_of(const render::RendererOptions& options, const render::World& world,
                         std::span<const render::HeadRequest> first_pings);

}  // namespace sonard::server
