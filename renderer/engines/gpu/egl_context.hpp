// SPDX-License-Identifier: Apache-2.0
// An OpenGL context without window or display server, as OpenSceneGraph wants it.
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
  /// @param device as GpuOptions::device.
  /// @throws RendererError saying what devices there are when no context can be made.
  explicit EglContext(const std::string& device);

  /// "vendor / renderer / version"; valid once realized and current.
  std::string describe() const;

  /// Whether a processor does the work, as the driver says.
  bool software() const { return software_; }

  /// @throws RendererError when the context is lost.
  void make_current_or_throw();

  /// @throws RendererError when the context is no longer current, or the driver has reset it. What was read
  /// from it since it was last checked is then worth nothing.
  void check() const;

  /// For tests: loses the context, as a driver does that is reset.
  void lose();

  /// Builds a program where it will be used; the context is current.
  /// @param what in the message: "the surface shader".
  /// @throws RendererError when it does not build.
  osg::ref_ptr<osg::Program> build_program(const std::vector<osg::ref_ptr<osg::Shader>>& shaders,
                                           const std::string& what);

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
  void* display_ = nullptr;  // EGLDisplay; kept opaque for those who include this
  void* context_ = nullptr;  // EGLContext
  bool software_ = false;
  bool realized_ = false;
};

}  // namespace sonard::render
