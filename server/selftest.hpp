// SPDX-License-Identifier: Apache-2.0
// `sonard selftest`: what can render here, whether it renders what it should, and how fast.
#pragma once

#include "renderer/renderer_options.hpp"

namespace sonard::server {

/// Prints the OpenGL devices of this machine and why one is taken, the error of each engine against a closed
/// form, and the times of both. With `automatic` a GPU that cannot be had is no failure.
/// @param json one JSON object (docs/deploy.md) instead of text
/// @return an exit code
/// @throws render::RendererError when the engine that is asked for fails; with `json` exit_renderer says so
int selftest(const render::RendererOptions& options, bool json);

}  // namespace sonard::server
