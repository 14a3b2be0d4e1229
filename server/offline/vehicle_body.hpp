// The vehicle's own model along a voyage.
#pragma once

#include <cstdint>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/offline/body_truth.hpp"
#include "server/offline/voyage.hpp"

namespace sonard::server {

/// Moves the model of the vehicle, where the voyage has one, to where the vehicle is at a time.
/// @param truth may be null
void place_vehicle(const Voyage& voyage, std::int64_t time_ns, render::SonarRenderer& renderer,
                   BodyTruth* truth);

}  // namespace sonard::server
