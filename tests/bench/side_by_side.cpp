// SPDX-License-Identifier: Apache-2.0
// sonard_side_by_side SCENE FILE.png: draws a scene by both engines and the oracle, and their differences.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <opencv2/core.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "renderer/picture/fan_image.hpp"
#include "renderer/picture/picture_file.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/bench/image_error.hpp"
#include "tests/bench/reference.hpp"
#include "tests/scenes/scenes.hpp"

namespace sonard::bench {
namespace {

constexpr double shown_db = 60;           // from the strongest bin down to black
constexpr double shown_difference = 0.2;  // relative to the truth, at full colour
constexpr double heard = 1e-2;            // relative to the beam's maximum: errors are computed above this
constexpr int radius_px = 460;

picture::FanShape shape_of(const test::Scene& scene) {
  const std::vector<double>& edges = scene.settings.aperture.beam_edges_rad;
  picture::FanShape shape;
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    shape.bearings_rad.push_back(-0.5 *
                                 (edges[b] + edges[b + 1]));  // pictures have positive bearings to starboard
  }
  shape.lines = scene.settings.range.count;
  shape.line_step_m = scene.settings.range.step_m;
  return shape;
}

/// Levels in decibels without spreading, as a sonar with TVG would show them. One row per line.
cv::Mat levels(const render::EchoImage& image, double strongest) {
  cv::Mat polar(image.bins, image.beams, CV_8UC1);
  for (int k = 0; k < image.bins; ++k) {
    for (int b = 0; b < image.beams; ++b) {
      const double value = static_cast<double>(image.at(b, k)) * std::pow(k + 0.5, 3) / strongest;
      const double db = 10 * std::log10(std::max(value, 1e-12));
      polar.at<unsigned char>(k, b) = cv::saturate_cast<unsigned char>(255 * (1 + db / shown_db));
    }
  }
  return polar;
}

double strongest_level(const render::EchoImage& image) {
  double strongest = 0;
  for (int k = 0; k < image.bins; ++k) {
    for (int b = 0; b < image.beams; ++b) {
      strongest = std::max(strongest, static_cast<double>(image.at(b, k)) * std::pow(k + 0.5, 3));
    }
  }
  return strongest;
}

/// |image / truth - 1| for bins whose truth exceeds the share `heard` of their beam's maximum.
cv::Mat differences(const render::EchoImage& image, const render::EchoImage& truth) {
  cv::Mat polar = cv::Mat::zeros(image.bins, image.beams, CV_8UC1);
  for (int b = 0; b < image.beams; ++b) {
    float most = 0;
    for (int k = 0; k < image.bins; ++k) {
      most = std::max(most, truth.at(b, k));
    }
    for (int k = 0; k < image.bins; ++k) {
      const double expected = static_cast<double>(truth.at(b, k));
      if (expected > heard * static_cast<double>(most)) {
        const double error = std::abs(static_cast<double>(image.at(b, k)) / expected - 1);
        polar.at<unsigned char>(k, b) = cv::saturate_cast<unsigned char>(255 * error / shown_difference);
      }
    }
  }
  return polar;
}

render::EchoImage render_with(const test::Scene& scene, render::EngineKind engine) {
  render::RendererOptions options;
  options.engine = engine;
  render::SonarRenderer renderer(scene.world, options);
  return renderer.render_echo(scene.request());
}

void draw(const std::string& name, const std::string& references, const std::string& file) {
  const test::Scene scene = test::make_scene(name);
  const std::optional<Reference> reference = find_reference(scene, references);
  if (!reference) {
    throw std::runtime_error(name + ": there is no reference image");
  }
  const render::EchoImage& truth = reference->image;
  const render::EchoImage cpu = render_with(scene, render::EngineKind::cpu);
  const render::EchoImage gpu = render_with(scene, render::EngineKind::gpu);
  const picture::FanImage fan(shape_of(scene), {radius_px, true});
  const double strongest = strongest_level(truth);
  const auto caption = [&](const char* engine, const render::EchoImage& image) {
    const ImageError error = compare_images(image, truth).value();
    return fmt::format(
        "|{} - oracle| / oracle, white: {:.0f} %. RMS {:.2f} %, without the worst 1 %: {:.2f} %", engine,
        100 * shown_difference, 100 * error.bin_rms, 100 * error.bin_rms_trim);
  };
  std::vector<cv::Mat> rows(3);
  cv::hconcat(fan.draw(levels(cpu, strongest), "engine cpu, preset default"),
              fan.draw(levels(gpu, strongest), "engine gpu, preset default"), rows[0]);
  cv::hconcat(fan.draw(differences(cpu, truth), caption("cpu", cpu)),
              fan.draw(differences(gpu, truth), caption("gpu", gpu)), rows[1]);
  cv::hconcat(fan.draw(levels(truth, strongest), fmt::format("oracle, {:.0f} dB, r^3 taken out", shown_db)),
              fan.draw(differences(gpu, cpu), "|gpu - cpu| / cpu"), rows[2]);
  cv::Mat all;
  cv::vconcat(rows, all);
  const std::string png = picture::png_file(all, 9);
  if (!std::ofstream(file, std::ios::binary)
           .write(png.data(), static_cast<std::streamsize>(png.size()))
           .flush()) {
    throw std::runtime_error(file + ": cannot be written");
  }
}

}  // namespace
}  // namespace sonard::bench

int main(int argc, char** argv) {
  std::string scene;
  std::string file;
  std::string references = SONARD_SOURCE_DIR "/tests/data/oracle";
  CLI::App app("Draws a scene by both engines and the oracle, and what they differ by.");
  app.add_option("scene", scene, "Name of a scene with a reference image")->required();
  app.add_option("file", file, "PNG to write")->required();
  app.add_option("--references", references, "Folder of the oracle's images")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    sonard::bench::draw(scene, references, file);
  } catch (const std::exception& error) {
    fmt::print(stderr, "sonard_side_by_side: {}\n", error.what());
    return 1;
  }
  return 0;
}
