// SPDX-License-Identifier: Apache-2.0
// An OpenGL context without window or display server, for OpenSceneGraph.
#pragma once

#include <string>
#include <vector>

#include <osg/GraphicsContext>
#include <osg/Program>

namespace sonard::render {

/// OpenGL 4.5 compatibility context on an EGL device. It has no default framebuffer: draw to framebuffer
/// objects only. The thread that makes it current owns it.
class EglContext : public osg::GraphicsContext {
 public:
  /// Makes a context and makes it current.
  /// @param device see GpuOptions::device
  /// @throws RendererError, with a list of the devices, if no context can be made
  static osg::ref_ptr<EglContext> made_current(const std::string& device);

  /// "vendor / renderer / version". The context must be current.
  std::string describe() const;

  /// True if OpenGL runs on the CPU, according to the driver.
  bool software() const { return software_; }

  /// @throws RendererError if the context is lost
  void make_current_or_throw();

  /// @throws RendererError if the context is no longer current, or the driver has reset it; data read since
  /// the last check() are then invalid
  void check() const;

  /// For tests: loses the context, like a reset of the driver.
  void lose();

  /// Builds a program for this context, which must be current.
  /// @param what name in the error message: "the surface shader"
  /// @param blocks its uniform blocks, in the order of their bindings
  /// @throws RendererError if it does not build
  osg::ref_ptr<osg::Program> build_program(const std::vector<osg::ref_ptr<osg::Shader>>& shaders,
                                           const std::string& what,
                                           const std::vector<std::string>& blocks = {});

  bool valid() const override { return context_ != nullptr; }
  bool realizeImplementation() override;
  bool isRealizedImplementation() const override { return realized_; }
  void closeImplementation() override;
  bool makeCurrentImplementation() override;
  bool makeContextCurrentImplementation(osg::GraphicsContext* /*read_context*/) override {
    return makeCurrentImplementation();
  }
  bool releaseContextImplementation() override;
  void bindPBufferToTextureImplementation(GLenum /*buffer*/) override {}
  void swapBuffersImplementation() override {}

 protected:
  ~EglContext() override;

 private:
  explicit EglContext(const std::string& device);

  void* display_ = nullptr;  // EGLDisplay; opaque, so that includers do not need EGL
  void* context_ = nullptr;  // EGLContext
  bool software_ = false;
  bool realized_ = false;
};

}  // namespace sonard::render
