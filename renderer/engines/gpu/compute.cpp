// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/compute.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <osg/State>

#include "renderer/engines/gpu/records.hpp"

namespace sonard::render {

Compute::Compute(EglContext& context, int group, bool time_stages)
    : context_(context),
      gl_(*osg::GLExtensions::Get(context.getState()->getContextID(), true)),
      group_(group > 0            ? group
             : context.software() ? 8
                                  : 64),
      is_timed_(time_stages) {}

osg::ref_ptr<osg::Program> Compute::build(const std::string& name, const char* text,
                                          const std::string& defines, int least_group) const {
  const std::string source =
      fmt::format("#version 430\n#define GROUP {}u\n", std::max(group_, least_group)) + defines + text;
  osg::ref_ptr<osg::Program> program = context_.build_program({new osg::Shader(osg::Shader::COMPUTE, source)},
                                                              name, {"PingBlock", "EchoBlock"});
  program->setName(name);
  return program;
}

void Compute::use(const osg::ref_ptr<osg::Program>& program, Buffers blocks, Buffers buffers) const {
  stage_ = program->getName();
  program->getPCP(*context_.getState())->useProgram();
  const auto bind = [this](GLenum target, Buffers all) {
    for (GLuint binding = 0; const GpuBuffer* buffer : all) {
      gl_.glBindBufferBase(target, binding++, buffer->name());
    }
  };
  bind(GL_UNIFORM_BUFFER, blocks);
  bind(GL_SHADER_STORAGE_BUFFER, buffers);
}

void Compute::dispatch(std::size_t groups) const {
  const std::size_t rows = (groups + records::most_groups - 1) / records::most_groups;
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

}  // namespace sonard::render
