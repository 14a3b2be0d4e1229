// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/compute.hpp"

#include <fmt/format.h>
#include <osg/State>

#include "renderer/engines/gpu/gl_errors.hpp"
#include "renderer/engines/gpu/gpu_readback.hpp"
#include "renderer/engines/gpu/shaders.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

Compute::Compute(EglContext& context, int group)
    : context_(context),
      gl_(*osg::GLExtensions::Get(context.getState()->getContextID(), true)),
      group_(group > 0            ? group
             : context.software() ? 8
                                  : 64) {}

osg::ref_ptr<osg::Program> Compute::build(const std::string& name, const char* text,
                                          const std::string& defines) const {
  std::string source = fmt::format("#version 430\n#define GROUP {}u\n", group_) + defines;
  for (const char* common :
       {shaders::language_glsl, shaders::cut_glsl, shaders::place_glsl, shaders::sweep_glsl,
        shaders::sides_glsl, shaders::refine_glsl, shaders::ping_glsl}) {
    source += common;
  }
  osg::ref_ptr<osg::Program> program = context_.build_program(
      {new osg::Shader(osg::Shader::COMPUTE, source + text)}, name, {"Ping", "Echo", "Refinement"});
  program->setName(name);
  return program;
}

void Compute::use(const osg::ref_ptr<osg::Program>& program, Buffers blocks, Buffers buffers) const {
  stage_ = program->getName();
  program->getPCP(*context_.getState())->useProgram();
  const auto bind = [this](GLenum target, Buffers all) {
    for (GLuint binding = 0; const GpuBuffer* buffer : all) {
      if (buffer != nullptr) {
        gl_.glBindBufferBase(target, binding, buffer->name());
      }
      ++binding;
    }
  };
  bind(GL_UNIFORM_BUFFER, blocks);
  bind(GL_SHADER_STORAGE_BUFFER, buffers);
}

void Compute::dispatch(std::size_t groups) const {
  const std::size_t rows = (groups + most_groups - 1) / most_groups;
  if (groups > 0) {
    gl_.glDispatchCompute(static_cast<GLuint>((groups + rows - 1) / rows), static_cast<GLuint>(rows), 1);
  }
  end_dispatch();
}

void Compute::dispatch_indirect(const GpuBuffer& groups, std::size_t first_byte) const {
  // OpenSceneGraph does not load this function.
  using DispatchComputeIndirect = void(GL_APIENTRY*)(GLintptr);
  static const auto run =
      reinterpret_cast<DispatchComputeIndirect>(osg::getGLExtensionFuncPtr("glDispatchComputeIndirect"));
  gl_.glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, groups.name());
  run(static_cast<GLintptr>(first_byte));
  end_dispatch();
}

void Compute::end_dispatch() const {
  gl_.glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
  ++dispatches_;
  stamp(stage_);
}

void Compute::begin_stages() const {
  stamp("");
}

// Not GL_TIME_ELAPSED: llvmpipe measures 0 with it for compute shaders.
void Compute::stamp(const std::string& stage) const {
  if (is_timed_) {
    stamps_.push_back({stage, 0});
    gl_.glGenQueries(1, &stamps_.back().query);
    gl_.glQueryCounter(stamps_.back().query, GL_TIMESTAMP);
  }
}

std::map<std::string, double> Compute::take_stages_ms() const {
  constexpr double ms_per_ns = 1e-6;
  std::map<std::string, double> stages_ms;
  GLuint64 last_ns = 0, now_ns = 0;
  for (const Stamp& stamp : stamps_) {
    gl_.glGetQueryObjectui64v(stamp.query, GL_QUERY_RESULT, &now_ns);
    gl_.glDeleteQueries(1, &stamp.query);
    if (!stamp.stage.empty()) {
      stages_ms[stamp.stage] += ms_per_ns * static_cast<double>(now_ns - last_ns);
    }
    last_ns = now_ns;
  }
  stamps_.clear();
  return stages_ms;
}

void Compute::read_bytes(const GpuBuffer& buffer, std::span<std::byte> bytes) const {
  gl_.glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  GpuReadback readback(gl_);
  readback.ask({{buffer, bytes.size()}});
  if (!readback.wait(
          [&](std::span<const std::byte> got) { std::memcpy(bytes.data(), got.data(), got.size()); })) {
    throw RendererError("the OpenGL context is lost");
  }
  check_gl_errors("computing slices");
}

}  // namespace sonard::render
