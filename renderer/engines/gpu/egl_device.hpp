// SPDX-License-Identifier: Apache-2.0
// The devices of EGL, and a context on one.
#pragma once

#include <string>
#include <vector>

#include <EGL/egl.h>

namespace sonard::render {

struct EglDevice {
  EGLDisplay display = EGL_NO_DISPLAY;
  std::string node;       ///< "/dev/dri/card0"; empty: no node
  bool software = false;  ///< according to its driver
};

/// The devices that EGL lists, in its order; the surfaceless platform if EGL cannot list devices.
std::vector<EglDevice> egl_devices();

/// Context of OpenGL 4.5, compatibility profile, that reports resets if the driver supports it.
/// EGL_NO_CONTEXT if the display does not support OpenGL 4.5.
EGLContext make_egl_context(EGLDisplay display);

/// "vendor / renderer / version" of the current context.
std::string describe_current_gl();

}  // namespace sonard::render
