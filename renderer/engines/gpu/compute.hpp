// SPDX-License-Identifier: Apache-2.0
// Builds and runs the compute shaders of slices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
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
  /// @param time_stages for the benchmark: takes the time of every dispatch
  Compute(EglContext& context, int group, bool time_stages);

  osg::GLExtensions& gl() const { return gl_; }

  /// @param name of the shader's file, for messages
  /// @param text of the shader (shaders.hpp)
  /// @param defines lines before it, which set its macros; GROUP is set too
  /// @param least_group at least as many invocations in a group
  /// @throws RendererError if it does not build
  osg::ref_ptr<osg::Program> build(const std::string& name, const char* text, const std::string& defines = "",
                                   int least_group = 1) const;

  using Buffers = std::initializer_list<const GpuBuffer*>;  ///< in the order of their bindings
  /// Selects a program for dispatch(), with its uniform blocks and its storage buffers.
  void use(const osg::ref_ptr<osg::Program>& program, Buffers blocks, Buffers buffers) const;

  /// Runs the selected program; later ones see what it has written.
  void dispatch(std::size_t groups) const;
  /// use() and dispatch().
  void run(const osg::ref_ptr<osg::Program>& program, Buffers blocks, Buffers buffers,
           std::size_t groups) const {
    use(program, blocks, buffers);
    dispatch(groups);
  }
  /// Runs it in as many groups as the GPU finds in three words of a buffer.
  void dispatch_indirect(const GpuBuffer& groups, std::size_t first_byte) const;

  std::uint64_t dispatches() const { return dispatches_; }

  /// Begins the first stage of a ping. A stage goes from the end of the one before to its own end, so it
  /// includes what is uploaded and cleared for it.
  void begin_stages() const;
  /// Milliseconds of the GPU for each shader's file since the last call. Waits for the GPU. Empty if no time
  /// is taken
  std::map<std::string, double> take_stages_ms() const;

 private:
  void end_dispatch() const;
  void stamp(const std::string& stage) const;

  EglContext& context_;
  osg::GLExtensions& gl_;
  const int group_;
  const bool is_timed_;
  mutable std::uint64_t dispatches_ = 0;
  mutable std::string stage_;  ///< of the selected program
  struct Stamp {
    std::string stage;  ///< that ends here; empty: none
    GLuint query;
  };
  mutable std::vector<Stamp> stamps_;
};

}  // namespace sonard::render
