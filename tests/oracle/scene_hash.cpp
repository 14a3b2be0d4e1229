// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/scene_hash.hpp"

#include <cmath>
#include <span>

#include "tests/oracle/sha256.hpp"

namespace sonard::oracle {

namespace {

/// Adds numbers to the hash, rounded to a step.
class Fingerprint {
 public:
  void count(std::size_t n) { exact(static_cast<double>(n)); }
  void exact(double value) { hash_.add(std::as_bytes(std::span(&value, 1))); }
  void fine(double value) { exact(std::round(value * 1e9) + 0.0); }  // + 0.0: no negative zero
  void coarse(double value) { exact(std::round(value * 1e6) + 0.0); }

  template <class Vector>
  void vectors(const std::vector<Vector>& values) {
    count(values.size());
    for (const Vector& value : values) {
      for (glm::length_t i = 0; i < Vector::length(); ++i) {
        coarse(static_cast<double>(value[i]));
      }
    }
  }

  void pose(const render::Pose& T) {
    coarse(T.position_m.x), coarse(T.position_m.y), coarse(T.position_m.z);
    const double sign = T.orientation.w < 0 ? -1.0 : 1.0;  // q and -q are the same rotation
    fine(sign * T.orientation.w), fine(sign * T.orientation.x);
    fine(sign * T.orientation.y), fine(sign * T.orientation.z);
  }

  void mesh(const render::TriangleMesh& mesh) {
    vectors(mesh.positions);
    vectors(mesh.normals);
    vectors(mesh.texcoords);
    vectors(mesh.tangents);
    count(mesh.indices.size());
    hash_.add(std::as_bytes(std::span(mesh.indices)));
  }

  void normal_map(const render::NormalMap* map) {
    count(map ? map->rgb.size() : 0);
    if (map) {
      count(static_cast<std::size_t>(map->width_px));
      hash_.add(std::as_bytes(std::span(map->rgb)));
    }
  }

  void settings(const render::SonarSettings& settings) {
    count(settings.aperture.beam_edges_rad.size());
    for (const double edge : settings.aperture.beam_edges_rad) {
      fine(edge);
    }
    fine(settings.aperture.vertical_beamwidth_rad);
    exact(static_cast<int>(settings.aperture.elevation));
    exact(settings.range.count);
    fine(settings.range.step_m);
    const bool paper = settings.model == render::Model::paper;
    exact(paper ? 1 : 0);
    fine(paper ? settings.paper.sigmoid_slope : settings.physical.absorption_db_per_m);
    fine(paper ? settings.paper.sigmoid_centre : 0);
    fine(paper ? settings.paper.attenuation_per_m : 0);
    exact(paper && !settings.paper.two_sided ? 1 : 0);
  }

  std::string digest() { return hash_.hex_digest(); }

 private:
  Sha256 hash_;
};

}  // namespace

std::string scene_hash(const render::World& world, const render::Pose& T_world_sonar,
                       const render::SonarSettings& settings) {
  const bool hears_facets =
      settings.model == render::Model::physical &&
      settings.physical.backscatter == render::PhysicalModel::Backscatter::lambert_facet;
  Fingerprint fingerprint;
  fingerprint.settings(settings);
  fingerprint.pose(T_world_sonar);
  fingerprint.count(world.bodies.size());
  for (const render::Body& body : world.bodies) {
    fingerprint.pose(body.T_world_body);
    fingerprint.count(body.parts.size());
    for (const render::BodyPart& part : body.parts) {
      fingerprint.pose(part.T_body_part);
      fingerprint.fine(part.material.lambert_mu);
      if (hears_facets && part.material.pressure_reflection != 0) {
        fingerprint.fine(part.material.pressure_reflection);
        fingerprint.fine(part.material.rms_slope);
      }
      fingerprint.fine(part.material.reflectance);
      fingerprint.mesh(*part.mesh);
      fingerprint.normal_map(part.normal_map.get());
    }
  }
  return fingerprint.digest();
}

}  // namespace sonard::oracle
