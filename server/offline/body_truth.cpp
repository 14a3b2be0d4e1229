// SPDX-License-Identifier: Apache-2.0
#include "server/offline/body_truth.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sonard::server {
namespace {

/// In mode `paper` a silent surface still has a small echo, sigmoid(0).
constexpr float paper_silence = 1e-5F;

render::SonarSettings truth_settings(render::SonarSettings settings) {
  settings.transmit = true;
  settings.sampling.within_facets = true;
  settings.aperture.azimuth = render::Aperture::Azimuth::ideal;
  settings.physical.pulse.shape = render::PulseSettings::Shape::point;
  settings.physical.multipath.level = render::MultipathSettings::Level::off;
  settings.physical.water_clutter.density_per_m3 = 0.0;
  settings.physical.volume_scattering_db = -std::numeric_limits<double>::infinity();
  return settings;
}

void silence(render::Body& body) {
  for (render::BodyPart& part : body.parts) {
    part.material.reflectance = 0.0;
    part.material.lambert_mu = 0.0;
    part.material.pressure_reflection = 0.0;
  }
}

/// Takes the bins in which this body is louder than all earlier ones. Behind an echo, binning leaves rounding
/// errors of about 1e-7 of it, which do not count.
void keep_loudest(const render::EchoImage& echo, int compression_log2, std::uint16_t id,
                  std::vector<float>& loudest, std::vector<std::uint16_t>& ids) {
  constexpr float rounding = 1e-6F;
  const int lines = echo.bins >> compression_log2;
  for (int beam = 0; beam < echo.beams; ++beam) {
    float loudest_of_body = 0.0F;
    for (int line = 0; line < lines; ++line) {
      float sum = 0.0F;
      for (int native = line << compression_log2; native < (line + 1) << compression_log2; ++native) {
        sum += echo.at(beam, native);
      }
      loudest_of_body = std::max(loudest_of_body, sum);
      const auto bin = static_cast<std::size_t>(line) * static_cast<std::size_t>(echo.beams) +
                       static_cast<std::size_t>(beam);
      if (sum > loudest[bin] && sum > rounding * loudest_of_body) {
        loudest[bin] = sum;
        ids[bin] = id;
      }
    }
  }
}

/// Takes the directions in which this body is louder than all earlier ones.
void keep_loudest(const render::DirectionEchoes& echoes, std::uint16_t id, std::vector<float>& loudest,
                  std::vector<std::uint16_t>& ids) {
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (echoes.range_m[i] > 0.0F && echoes.intensity[i] > loudest[i]) {
      loudest[i] = echoes.intensity[i];
      ids[i] = id;
    }
  }
}

}  // namespace

BodyTruth::BodyTruth(render::World world, const render::RendererOptions& options)
    : world_(std::move(world)), options_(options) {
  options_.engine = render::EngineKind::cpu;
  for (const render::Body& body : world_.bodies) {
    balls_.push_back(ball_around(body));
  }
}

std::vector<std::string> BodyTruth::bodies() const {
  std::vector<std::string> names;
  for (const render::Body& body : world_.bodies) {
    names.push_back(body.name);
  }
  return names;
}

void BodyTruth::set_body_pose(const std::string& name, const render::Pose& T_world_body) {
  for (std::size_t i = 0; i < world_.bodies.size(); ++i) {
    render::Body& body = world_.bodies[i];
    if (body.name == name && !(body.T_world_body == T_world_body)) {
      body.T_world_body = T_world_body;
      balls_[i] = ball_around(body);
      for (const auto& [number, renderer] : renderers_) {
        renderer->set_body_pose(name, T_world_body);
      }
    }
  }
}

BodyTruth::Ball BodyTruth::ball_around(const render::Body& body) {
  if (body.parts.empty()) {
    return {glm::dvec3(0.0), -std::numeric_limits<double>::infinity()};  // never near
  }
  constexpr double huge = std::numeric_limits<double>::max();
  glm::dvec3 low(huge), high(-huge);
  for (const render::BodyPart& part : body.parts) {
    const render::Pose T_world_part = body.T_world_body * part.T_body_part;
    for (const glm::vec3& position : part.mesh->positions) {
      const glm::dvec3 corner = T_world_part * glm::dvec3(position);
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
  }
  return {(low + high) / 2.0, glm::length(high - low) / 2.0};
}

render::SonarRenderer& BodyTruth::renderer_of(std::size_t body) {
  std::unique_ptr<render::SonarRenderer>& renderer = renderers_[body];
  if (!renderer) {
    render::World alone = world_;
    for (std::size_t other = 0; other < alone.bodies.size(); ++other) {
      if (other != body) {
        silence(alone.bodies[other]);
      }
    }
    renderer = std::make_unique<render::SonarRenderer>(alone, options_);
  }
  return *renderer;
}

std::vector<std::uint16_t> BodyTruth::bodies_in(const render::PingRequest& request) {
  render::PingRequest alone = request;
  alone.settings = truth_settings(request.settings);
  const render::RangeBins& range = request.settings.range;
  const render::DirectionGrid& grid = request.settings.directions;
  const std::size_t samples =
      grid.any() ? static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows)
                 : static_cast<std::size_t>(range.output_count()) *
                       static_cast<std::size_t>(request.settings.aperture.beam_count());
  const bool paper = request.settings.model == render::Model::paper;
  std::vector<float> loudest(samples,
                             paper ? paper_silence * static_cast<float>(1 << range.compression_log2) : 0.0F);
  std::vector<std::uint16_t> ids(samples, 0);
  for (std::size_t body = 0; body < balls_.size(); ++body) {
    const double distance_m = glm::length(balls_[body].centre_m - request.T_world_sonar.position_m);
    if (distance_m - balls_[body].radius_m >= range.max_range_m()) {
      continue;
    }
    const auto id = static_cast<std::uint16_t>(body + 1);
    if (grid.any()) {
      keep_loudest(renderer_of(body).render_directions(alone), id, loudest, ids);
    } else {
      keep_loudest(renderer_of(body).render_echo(alone), range.compression_log2, id, loudest, ids);
    }
  }
  return ids;
}

npy::Table BodyTruth::table(int rows, int columns, const std::vector<std::uint16_t>& ids) const {
  if (world_.bodies.size() > std::numeric_limits<std::uint8_t>::max()) {
    return {rows, columns, {}, ids};
  }
  npy::Table table{rows, columns, {}, {}};
  std::transform(ids.begin(), ids.end(), std::back_inserter(table.u8),
                 [](std::uint16_t id) { return static_cast<std::uint8_t>(id); });
  return table;
}

}  // namespace sonard::server
