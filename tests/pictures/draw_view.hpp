// SPDX-License-Identifier: Apache-2.0
// Draws a view as on a sonar display.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "renderer/renderer_options.hpp"
#include "tests/pictures/view.hpp"

namespace sonard::pictures {

/// Renders the ping of `view` (for a scanning head, the turn) with seed 1 and draws it as seen from above:
/// CV_8UC3, BGR.
/// @param radius_px from the sonar to the full range
/// @throws render::RequestError, render::RendererError
cv::Mat draw_view(const View& view, render::EngineKind engine, int radius_px, const std::string& caption);

}  // namespace sonard::pictures
