// SPDX-License-Identifier: Apache-2.0
// What comes back from the GPU, without waiting for what it was given to do later.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <osg/GLExtensions>

#include "renderer/engines/gpu/gpu_buffer.hpp"

namespace sonard::render {

/// Copies of buffers as they were when they were asked for. Made, used and deleted while its context is
/// current.
class GpuReadback {
 public:
  explicit GpuReadback(osg::GLExtensions& gl);
  ~GpuReadback();
  GpuReadback(const GpuReadback&) = delete;
  GpuReadback& operator=(const GpuReadback&) = delete;

  struct Part {
    const GpuBuffer& buffer;
    std::size_t bytes;  ///< from its beginning
  };
  /// Has the GPU copy all of this, one part behind the other, once it is done with what it was given so far.
  void ask(const std::vector<Part>& parts);

  /// Waits until the parts are there, and hands their bytes on. What the GPU was given after ask() goes on
  /// meanwhile.
  /// @return false, and hands on nothing, when they were lost with the context or do not come within a
  /// minute.
  bool wait(const std::function<void(std::span<const std::byte>)>& take);

 private:
  osg::GLExtensions& gl_;
  GLuint name_ = 0;
  std::size_t room_ = 0, bytes_ = 0;
  GLsync done_ = nullptr;
};

}  // namespace sonard::render
