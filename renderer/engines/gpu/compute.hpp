// SPDX-License-Identifier: Apache-2.0
// Builds and runs the compute shaders of slices.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <osg/GLExtensions>
#include <osg/Program>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gpu_buffer.hpp"

namespace sonard::render {

/// A context, which must be current in every call.
class Compute {
 public:
  /// @param group invocations of a group; 0: as many as suit the device
  explicit Compute(EglContext& context, int group = 0);

  osg::GLExtensions& gl() const { return gl_; }

  /// @param name of the shader's file, for messages
  /// @param text of the shader, without what all shaders have in common: GROUP, slices/*.glsl, ping.glsl
  /// @param defines lines before all of them
  /// @throws RendererError if it does not build
  osg::ref_ptr<osg::Program> build(const std::string& name, const char* text,
                                   const std::string& defines = "") const;

  /// Selects a program for dispatch(). @param ping its uniform block Ping
  void use(const osg::ref_ptr<osg::Program>& program, const GpuBuffer& ping) const;

  /// Runs the selected program; later ones see what it has written.
  void dispatch(std::size_t groups) const;
  /// Runs it in as many groups as the GPU finds in three words of a buffer.
  void dispatch_indirect(const GpuBuffer& groups, std::size_t first_byte) const;

  /// Waits for the GPU. @throws RendererError if the context is lost
  template <class T>
  std::vector<T> read(const GpuBuffer& buffer, std::size_t count) const {
    std::vector<T> values(count);
    read_bytes(buffer, std::as_writable_bytes(std::span(values)));
    return values;
  }

 private:
  void read_bytes(const GpuBuffer& buffer, std::span<std::byte> bytes) const;

  EglContext& context_;
  osg::GLExtensions& gl_;
  int group_;
};

}  // namespace sonard::render
