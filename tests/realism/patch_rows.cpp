// SPDX-License-Identifier: Apache-2.0
// How spiky the beds of the shipped worlds are, by the estimator that was used for recordings.
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/pictures/view.hpp"
#include "tests/realism/patches.hpp"
#include "tests/realism/rows.hpp"

namespace sonard::realism {
namespace {

/// 8-bit samples as amplitudes: inverts the output scale.
AmplitudeImage amplitudes_of(const render::PingSamples& samples, const render::SonarSettings& settings) {
  AmplitudeImage image{samples.bins, samples.beams, 255, {}};
  const bool power = settings.output_scale == render::OutputScale::power;
  const auto amplitude_of = [&](double code) {
    return power ? 255 * std::pow(code / 255, 1 / settings.output_exponent) : code;
  };
  image.full_scale = amplitude_of(power ? 254 : 255);  // the highest code does not occur on a power scale
  for (const std::uint8_t code : samples.u8) {
    image.amplitude.push_back(amplitude_of(code));
  }
  return image;
}

constexpr std::uint64_t draws = 12;

/// Patches from many draws of speckle and elements: medians over the patches of three draws vary by 0.01.
std::vector<Patch> patches_of(const std::string& config, double range_m) {
  pictures::View view = pictures::configured_view(config, range_m);
  view.settings.range.compression_log2 = 0;  // means of lines are less spiky than lines
  render::SonarRenderer renderer(view.world, {render::EngineKind::cpu, 0});
  std::vector<Patch> patches;
  for (std::uint64_t seed = 1; seed <= draws; ++seed) {
    render::PingRequest request;
    request.T_world_sonar = view.T_world_sonar;
    request.settings = view.settings;
    request.seed = seed;
    for (const Patch& patch :
         homogeneous_patches(amplitudes_of(renderer.render_ping(request), view.settings))) {
      patches.push_back(patch);
    }
  }
  std::ranges::sort(patches, {}, &Patch::mean);
  return patches;
}

/// The value in the middle and in the bright third of all patches.
std::array<double, 2> measure(const std::string& config, double range_m, double Patch::*of) {
  static std::map<std::pair<std::string, double>, std::vector<Patch>> seen;
  const auto [found, is_new] = seen.try_emplace({config, range_m});
  if (is_new) {
    found->second = patches_of(config, range_m);
  }
  return {median_of(found->second, Third::middle).*of, median_of(found->second, Third::bright).*of};
}

}  // namespace

std::vector<PatchRow> patch_rows() {
  std::vector<PatchRow> rows;
  for (const auto& [head, config] :
       {std::pair{"Gemini", "demo.yaml"}, std::pair{"Gemini", "ssiv.yaml"},
        std::pair{"Gemini", "manifold.yaml"}, std::pair{"Gemini", "two-vehicles-b.yaml"},
        std::pair{"Oculus", "demo-oculus.yaml"}}) {
    for (const double range_m : {20.0, 30.0}) {
      const std::string file = config;
      rows.push_back({head, fmt::format("{} to {:.0f} m", config, range_m),
                      [=] { return measure(file, range_m, &Patch::variation); },
                      [=] { return measure(file, range_m, &Patch::index); }});
    }
  }
  return rows;
}

}  // namespace sonard::realism
