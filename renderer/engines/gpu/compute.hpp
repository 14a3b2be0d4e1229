// SPDX-License-Identifier: Apache-2.0
// Builds and runs the compute shaders of slices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <map>
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

  using Buffers = std::initializer_list<const GpuBuffer*>;  ///< in the order of their bindings; null: none
  /// Selects a program for dispatch(), with its uniform blocks and its storage buffers.
  void use(const osg::ref_ptr<osg::Program>& program, Buffers blocks, Buffers buffers) const;

  /// Runs the selected program; later ones see what it has written.
  void dispatch(std::size_t groups) const;
  /// Runs it in as many groups as the GPU finds in three words of a buffer.
  void dispatch_indirect(const GpuBuffer& groups, std::size_t first_byte) const;

  std::uint64_t dispatches() const { return dispatches_; }

  /// For the benchmark: from now on, takes the time of every dispatch.
  void time_stages() { is_timed_ = true; }
  /// Begins the first stage of a ping. A stage goes from the end of the one before to its own end, so it
  /// includes what is uploaded and cleared for it.
  void begin_stages() const;
  /// Milliseconds of the GPU for each shader's file since the last call. Waits for the GPU. Empty without
  /// time_stages()
  std::map<std::string, double> take_stages_ms() const;

  /// Waits for the GPU. @throws RendererError if the context is lost
  template <class T>
  std::vector<T> read(const GpuBuffer& buffer, std::size_t count) const {
    std::vector<T> values(count);
    read_bytes(buffer, std::as_writable_bytes(std::span(values)));
    return values;
  }

 private:
  void end_dispatch() const;
  void stamp(const std::string& stage) const;
  void read_bytes(const GpuBuffer& buffer, std::span<std::byte> bytes) const;

  EglContext& context_;
  osg::GLExtensions& gl_;
  int group_;
  bool is_timed_ = false;
  mutable std::uint64_t dispatches_ = 0;
  mutable std::string stage_;  ///< of the selected program
  struct Stamp {
    std::string stage;  ///< that ends here; empty: none
    GLuint query;
  };
  mutable std::vector<Stamp> stamps_;
};

}  // namespace sonard::render
