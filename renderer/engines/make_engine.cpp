// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/make_engine.hpp"

#include "renderer/engines/cpu/cpu_engine.hpp"
#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gpu_engine.hpp"

namespace sonard::render {

ChosenEngine make_engine(SpatialIndex& index, WorkerPool& workers, const RendererOptions& options) {
  ChosenEngine chosen;
  chosen.kind = options.engine;
  std::string reason;
  if (options.engine == EngineKind::automatic) {
    const GlProbe gl = probe_gl();
    const bool hardware = !gl.description.empty() && !is_software_gl(gl.description);
    chosen.kind = hardware ? EngineKind::gpu : EngineKind::cpu;
    reason =
        gl.description.empty() ? "; auto found " + gl.problem : "; auto found OpenGL on " + gl.description;
  }
  if (chosen.kind == EngineKind::cpu) {
    chosen.engine = std::make_unique<CpuEngine>(index, workers, options);
  } else {
    chosen.engine = std::make_unique<GpuEngine>(index.world(), workers, options);
  }
  chosen.description = chosen.engine->description() + reason;
  return chosen;
}

}  // namespace sonard::render
