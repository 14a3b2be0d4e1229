// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/egl_context.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>
#include <osg/GL>

#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

/// Displays to try, best first: the devices EGL lists (hardware before software), then the surfaceless
/// platform.
std::vector<EGLDisplay> candidate_displays() {
  std::vector<EGLDisplay> displays;
  const auto query_devices =
      reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
  const auto platform_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (platform_display == nullptr) {
    return displays;
  }
  std::array<EGLDeviceEXT, 16> devices{};
  EGLint count = 0;
  if (query_devices != nullptr &&
      query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_TRUE) {
    for (EGLint i = 0; i < count; ++i) {
      displays.push_back(
          platform_display(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
    }
  }
  displays.push_back(platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  return displays;
}

/// EGL_NO_CONTEXT when this display cannot do OpenGL 4.5.
EGLContext make_context(EGLDisplay display) {
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
  const std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                         4,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         5,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT,
                                         EGL_NONE};
  return eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
}

}  // namespace

EglContext::EglContext() {
  for (EGLDisplay display : candidate_displays()) {
    EGLContext context = make_context(display);
    if (context == EGL_NO_CONTEXT) {
      continue;
    }
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE) {
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      display_ = display;
      context_ = context;
      break;
    }
    eglDestroyContext(display, context);
  }
  if (context_ == nullptr) {
    throw RendererError(
        "no OpenGL 4.5 through EGL: tried every EGL device and the surfaceless platform (is a GL driver, "
        "for example Mesa's libgl1-mesa-dri, installed and /dev/dri accessible?)");
  }
  setState(new osg::State);
  getState()->setGraphicsContext(this);
  getState()->setContextID(osg::GraphicsContext::createNewContextID());
}

EglContext::~EglContext() {
  close();  // calls closeImplementation() while this is still an EglContext
}

osg::ref_ptr<osg::Program> EglContext::build_program(const std::vector<osg::ref_ptr<osg::Shader>>& shaders,
                                                     const std::string& what) {
  osg::ref_ptr<osg::Program> program = new osg::Program;
  for (const osg::ref_ptr<osg::Shader>& shader : shaders) {
    program->addShader(shader);
  }
  program->compileGLObjects(*getState());
  const osg::Program::PerContextProgram& linked = *program->getPCP(*getState());
  if (!linked.isLinked()) {
    std::string reason;
    linked.getInfoLog(reason);
    throw RendererError(what + " does not build on " + describe() + ": " + reason);
  }
  return program;
}

std::string EglContext::describe() const {
  const auto text = [](GLenum name) {
    const GLubyte* value = glGetString(name);
    return value == nullptr ? std::string("unknown") : std::string(reinterpret_cast<const char*>(value));
  };
  return fmt::format("{} / {} / {}", text(GL_VENDOR), text(GL_RENDERER), text(GL_VERSION));
}

bool EglContext::realizeImplementation() {
  realized_ = valid();
  return realized_;
}

void EglContext::closeImplementation() {
  realized_ = false;
  if (context_ != nullptr) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    context_ = nullptr;
  }
}

bool EglContext::makeCurrentImplementation() {
  return eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
}

bool EglContext::releaseContextImplementation() {
  return eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT) == EGL_TRUE;
}

GlProbe probe_gl() {
  try {
    const osg::ref_ptr<EglContext> context = new EglContext;
    context->realize();
    if (!context->makeCurrent()) {
      return {"", "an OpenGL context that cannot be used"};
    }
    GlProbe probe{context->describe(), ""};
    context->close();
    return probe;
  } catch (const RendererError& error) {
    return {"", error.what()};
  }
}

bool is_software_gl(std::string_view description) {
  std::string lower(description);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  // Mesa's rasterisers, and those of other vendors.
  constexpr std::array<std::string_view, 6> names{"llvmpipe",    "softpipe", "swrast",
                                                  "swiftshader", "lavapipe", "software rasterizer"};
  return std::any_of(names.begin(), names.end(),
                     [&](std::string_view name) { return lower.find(name) != std::string::npos; });
}

}  // namespace sonard::render
