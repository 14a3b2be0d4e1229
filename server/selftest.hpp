// SPDX-License-Identifier: Apache-2.0
// `sonard selftest`: which engines can render here, whether they render correctly, and how fast.
#pragma once

#include "renderer/renderer_options.hpp"

namespace sonard::server {

/// Prints the OpenGL devices of this machine and why one is chosen, the error of each engine against a closed
/// form, and the times of both. With `automatic`, an unavailable GPU is not an error.
/// @param json one JSON object (docs/deploy.md) instead of text
/// @return an exit code
/// @throws render::RendererError if the requested engine fails; with `json`, returns exit_renderer instead
int selftest(const render::RendererOptions& options, bool json);

}  // namespace sonard::server
