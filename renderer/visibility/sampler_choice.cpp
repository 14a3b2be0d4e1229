#include "renderer/visibility/sampler_choice.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include <osg/ref_ptr>

#include "renderer/errors.hpp"
#include "renderer/visibility/egl_context.hpp"
#include "renderer/visibility/raster_sampler.hpp"
#include "renderer/visibility/ray_sampler.hpp"

namespace sonard::render {

namespace {

struct GlProbe {
  std::string description;  ///< empty: there is none
  std::string problem;
};

GlProbe probe_gl() {
  try {
    const osg::ref_ptr<EglContext> context = new EglContext;
    context->realize();
    if (!context->makeCurrent()) {
      return {"", "an OpenGL context that cannot be used"};
    }
    GlProbe probe{context->describe(), ""};
    context->close();
    return probe;
  } catch (const RendererError& error) {
    return {"", error.what()};
  }
}

}  // namespace

bool is_software_gl(std::string_view description) {
  std::string lower(description);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  // Mesa's rasterisers, and those of other vendors.
  constexpr std::array<std::string_view, 6> names{"llvmpipe",    "softpipe", "swrast",
                                                  "swiftshader", "lavapipe", "software rasterizer"};
  return std::any_of(names.begin(), names.end(),
                     [&](std::string_view name) { return lower.find(name) != std::string::npos; });
}

ChosenSampler choose_sampler(SpatialIndex& index, Backend wanted, WorkerPool& workers) {
  std::string reason;
  if (wanted == Backend::automatic) {
    const GlProbe gl = probe_gl();
    wanted = gl.description.empty() || is_software_gl(gl.description) ? Backend::ray : Backend::raster;
    reason =
        gl.description.empty() ? "; auto found " + gl.problem : "; auto found OpenGL on " + gl.description;
  }
  ChosenSampler chosen;
  chosen.backend = wanted;
  if (wanted == Backend::ray) {
    chosen.sampler = std::make_unique<RaySampler>(index, workers);
  } else {
    auto raster = std::make_unique<RasterSampler>(index.world());
    chosen.raster = raster.get();
    chosen.sampler = std::move(raster);
  }
  chosen.description = chosen.sampler->description() + reason;
  return chosen;
}

}  // namespace sonard::render
