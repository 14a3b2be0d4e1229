// SPDX-License-Identifier: Apache-2.0
// An OpenGL context without window or display server, as OpenSceneGraph wants it.
#pragma once

#include <string>
#include <string_view>

#include <osg/GraphicsContext>
#include <osg/Program>

namespace sonard::render {

/// OpenGL 4.5 compatibility context on an EGL device or, failing that, on a surfaceless display. It has no
/// default framebuffer: draw to framebuffer objects only. The thread that makes it current owns it.
class EglContext : public osg::GraphicsContext {
 public:
  /// @throws RendererError naming what was tried when no context can be made.
  EglContext();

  /// "vendor / renderer / version"; valid once realized and current.
  std::string describe() const;

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
  void* display_ = nullptr;  // EGLDisplay; kept opaque so that EGL headers stay in one file
  void* context_ = nullptr;  // EGLContext
  bool realized_ = false;
};

/// What OpenGL there is on this machine.
struct GlProbe {
  std::string description;  ///< "vendor / renderer / version"; empty: there is none
  std::string problem;      ///< why there is none
};

/// Makes a context and gives it up again.
GlProbe probe_gl();

/// Whether the renderer string of an OpenGL context ("vendor / renderer / version") names a rasteriser that
/// runs on the CPU.
bool is_software_gl(std::string_view description);

}  // namespace sonard::render
