// SPDX-License-Identifier: Apache-2.0
// The devices of EGL, and a context on one.
#pragma once

#include <string>
#include <vector>

#include <EGL/egl.h>

namespace sonard::render {

struct EglDevice {
  EGLDisplay display = EGL_NO_DISPLAY;
  std::string node;       ///< "/dev/dri/card0"; empty: it has none
  bool software = false;  ///< as its driver says
};

/// What EGL lists, in its order; where it cannot list devices, the surfaceless platform.
std::vector<EglDevice> egl_devices();

/// OpenGL 4.5, compatibility profile, that tells of resets where the driver can. EGL_NO_CONTEXT when this
/// display cannot do that.
EGLContext make_egl_context(EGLDisplay display);

/// "vendor / renderer / version" of the context that is current.
std::string describe_current_gl();

}  // namespace sonard::render
