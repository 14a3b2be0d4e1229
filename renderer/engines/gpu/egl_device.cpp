// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/egl_device.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include <EGL/eglext.h>
#include <fmt/format.h>
#include <osg/GL>

#include "renderer/engines/gpu/gl_devices.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

// From GL_NVX_gpu_memory_info, which drivers of several vendors support.
constexpr GLenum dedicated_memory_kib = 0x9047;

template <class Function>
Function egl_function(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

std::uint64_t memory_mib_of_current() {
  const GLubyte* extensions = glGetString(GL_EXTENSIONS);
  GLint kib = 0;
  if (extensions != nullptr &&
      std::string_view(reinterpret_cast<const char*>(extensions)).find("GL_NVX_gpu_memory_info") !=
          std::string_view::npos) {
    glGetIntegerv(dedicated_memory_kib, &kib);
  }
  return kib > 0 ? static_cast<std::uint64_t>(kib) >> 10U : 0;
}

}  // namespace

std::vector<EglDevice> egl_devices() {
  std::vector<EglDevice> found;
  const auto display_of = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  if (display_of == nullptr) {
    return found;
  }
  const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto query_text = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  std::array<EGLDeviceEXT, 64> devices{};
  EGLint count = 0;
  if (query_devices == nullptr || query_text == nullptr ||
      query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) != EGL_TRUE) {
    found.push_back({display_of(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr), "", false});
    return found;
  }
  for (EGLDeviceEXT device : std::span(devices).first(static_cast<std::size_t>(count))) {
    const char* text = query_text(device, EGL_EXTENSIONS);
    const std::string extensions = text == nullptr ? "" : text;
    const bool has_node = extensions.find("EGL_EXT_device_drm") != std::string::npos;
    const char* node = has_node ? query_text(device, EGL_DRM_DEVICE_FILE_EXT) : nullptr;
    found.push_back({display_of(EGL_PLATFORM_DEVICE_EXT, device, nullptr), node == nullptr ? "" : node,
                     extensions.find("EGL_MESA_device_software") != std::string::npos});
  }
  return found;
}

EGLContext make_egl_context(EGLDisplay display) {
  EGLint major = 0;
  EGLint minor = 0;
  if (display == EGL_NO_DISPLAY || eglInitialize(display, &major, &minor) != EGL_TRUE ||
      eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) {
    return EGL_NO_CONTEXT;
  }
  const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                     EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  if (eglChooseConfig(display, wanted.data(), &config, 1, &configs) != EGL_TRUE || configs < 1) {
    config = nullptr;  // EGL_KHR_no_config_context: a context for framebuffer objects needs no config
  }
  std::vector<EGLint> attributes{
      EGL_CONTEXT_MAJOR_VERSION,       4,
      EGL_CONTEXT_MINOR_VERSION,       5,
      EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT};
  std::vector<EGLint> with_resets = attributes;
  with_resets.insert(with_resets.end(),
                     {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET, EGL_NONE});
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, with_resets.data());
  if (context == EGL_NO_CONTEXT) {  // the driver does not report resets
    attributes.push_back(EGL_NONE);
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
  }
  return context;
}

std::string describe_current_gl() {
  const auto text = [](GLenum name) {
    const GLubyte* value = glGetString(name);
    return value == nullptr ? std::string("unknown") : std::string(reinterpret_cast<const char*>(value));
  };
  return fmt::format("{} / {} / {}", text(GL_VENDOR), text(GL_RENDERER), text(GL_VERSION));
}

std::vector<GlDevice> list_gl_devices() {
  std::vector<GlDevice> list;
  for (const EglDevice& device : egl_devices()) {
    GlDevice& listed = list.emplace_back(GlDevice{"", device.node, device.software, 0});
    EGLContext context = make_egl_context(device.display);
    if (context == EGL_NO_CONTEXT) {
      continue;
    }
    if (eglMakeCurrent(device.display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE) {
      listed.description = describe_current_gl();
      listed.software = listed.software || is_software_renderer(listed.description);
      listed.memory_mib = memory_mib_of_current();
      eglMakeCurrent(device.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    eglDestroyContext(device.display, context);
  }
  return list;
}

std::string software_gl(const std::string& wanted) {
  const std::vector<EglDevice> found = egl_devices();
  if (!found.empty() && std::ranges::all_of(found, [](const EglDevice& device) { return device.software; })) {
    return "EGL lists no other device";
  }
  try {
    const std::vector<GlDevice> devices = list_gl_devices();
    const GlDevice& taken = devices[choose_gl_device(devices, wanted).number];
    return taken.software ? taken.description : "";
  } catch (const RendererError&) {
    return "";  // no OpenGL, or not that device: the constructor of the engine reports it
  }
}

}  // namespace sonard::render
