// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/egl_context.hpp"

#include <vector>

#include <osg/GL>

#include "renderer/engines/gpu/egl_device.hpp"
#include "renderer/engines/gpu/gl_devices.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

[[noreturn]] void throw_lost() {
  throw RendererError("the OpenGL context is lost");
}

}  // namespace

EglContext::EglContext(const std::string& device) {
  const std::vector<GlDevice> devices = list_gl_devices();
  const std::size_t number = choose_gl_device(devices, device).number;
  display_ = egl_devices()[number].display;
  software_ = devices[number].software;
  context_ = make_egl_context(display_);
  if (context_ == EGL_NO_CONTEXT) {
    throw RendererError("OpenGL created one context, but no second one: " + devices[number].description);
  }
  setState(new osg::State);
  getState()->setGraphicsContext(this);
  getState()->setContextID(osg::GraphicsContext::createNewContextID());
  // Drawing code checks for errors itself; OpenSceneGraph would only print them.
  getState()->setCheckForGLErrors(osg::State::NEVER_CHECK_GL_ERRORS);
}

EglContext::~EglContext() {
  close();  // calls closeImplementation() while this is still an EglContext
}

osg::ref_ptr<osg::Program> EglContext::build_program(const std::vector<osg::ref_ptr<osg::Shader>>& shaders,
                                                     const std::string& what,
                                                     const std::vector<std::string>& blocks) {
  osg::ref_ptr<osg::Program> program = new osg::Program;
  for (unsigned i = 0; i < blocks.size(); ++i) {
    program->addBindUniformBlock(blocks[i], i);  // without it, OpenSceneGraph complains
  }
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

osg::ref_ptr<EglContext> EglContext::made_current(const std::string& device) {
  osg::ref_ptr<EglContext> context = new EglContext(device);
  context->realize();
  context->make_current_or_throw();
  return context;
}

std::string EglContext::describe() const {
  return describe_current_gl();
}

void EglContext::make_current_or_throw() {
  if (!makeCurrent()) {
    throw_lost();
  }
}

void EglContext::check() const {
  static const auto reset_status =
      reinterpret_cast<GLenum (*)()>(eglGetProcAddress("glGetGraphicsResetStatus"));
  if (eglGetCurrentContext() != context_ || (reset_status != nullptr && reset_status() != GL_NO_ERROR)) {
    throw_lost();
  }
}

void EglContext::lose() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
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

}  // namespace sonard::render
