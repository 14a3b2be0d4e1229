// SPDX-License-Identifier: Apache-2.0
// `sonard selftest`: what can render here, whether it renders what it should, and how fast.
#pragma once

#include "renderer/renderer_options.hpp"

namespace sonard::server {

/// Prints the OpenGL devices of this machine and why one is taken, the error of each engine against a closed
/// form, and the times of both. With `automatic` a GPU that cannot be had is no failure.
/// @return an exit code
/// @throws render::RendererError when the engine that is asked for fails.
int selftest(const render::RendererOptions& options);

}  // namespace sonard::server
