// SPDX-License-Identifier: Apache-2.0
// A view as a person would see it on a display.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "renderer/renderer_options.hpp"
#include "tests/pictures/view.hpp"

namespace sonard::pictures {

/// Renders the ping (of a scanning head: the turn) of `view` with seed 1 and draws it seen from above:
/// CV_8UC3, BGR. `radius_px`: from the sonar to the full range.
/// @throws render::RequestError, render::RendererError
cv::Mat draw_view(const View& view, render::EngineKind engine, int radius_px, const std::string& caption);

}  // namespace sonard::pictures
