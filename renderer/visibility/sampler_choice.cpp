#include "renderer/visibility/sampler_choice.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "renderer/errors.hpp"
#include "renderer/visibility/raster_sampler.hpp"

namespace sonard::render {

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

ChosenSampler choose_sampler(const World& world, Backend wanted, WorkerPool& /*workers*/) {
  if (wanted == Backend::ray) {
    throw RendererError("the ray backend is not built in");
  }
  auto sampler = std::make_unique<RasterSampler>(world);
  std::string description = sampler->description();
  return {std::move(sampler), Backend::raster, std::move(description)};
}

}  // namespace sonard::render
