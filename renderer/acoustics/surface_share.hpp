// SPDX-License-Identifier: Apache-2.0
// EchoImage::surface_share: the part of the strongest echo of a line that surfaces return.
#pragma once

#include <vector>

#include "renderer/ping.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// The largest intensity of each line over all beams.
std::vector<float> strongest_of_lines(const EchoImage& image, WorkerPool& workers);

/// Divides, per line, the strongest echo of surfaces by the strongest echo of surfaces and water; 0 if the
/// latter is 0.
/// @param of_surfaces becomes the share
void divide(std::vector<float>& of_surfaces, const std::vector<float>& of_all);

}  // namespace sonard::render
