// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/engine_switch.hpp"

#include <vector>

#include <fmt/format.h>

#include "renderer/engines/cpu/cpu_engine.hpp"
#include "renderer/engines/gpu/gpu_engine.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

EngineSwitch::EngineSwitch(SpatialIndex& index, WorkerPool& workers, const RendererOptions& options)
    : index_(index), workers_(workers), options_(options) {
  use(options.engine == EngineKind::gpu ? EngineKind::gpu : EngineKind::cpu);
}

void EngineSwitch::use(EngineKind engine) {
  if (engine == EngineKind::gpu) {
    make_gpu();
    wants_gpu_ = true;
  } else {
    cpu();
    wants_gpu_ = false;
    gpu_.reset();
  }
  describe();
}

EchoEngine& EngineSwitch::cpu() {
  if (!cpu_) {
    cpu_ = std::make_unique<CpuEngine>(index_, workers_, options_);
    cpu_->set_refraction(bend_per_m_);
  }
  return *cpu_;
}

void EngineSwitch::make_gpu() {
  if (!gpu_) {
    gpu_ = std::make_unique<GpuEngine>(index_.world(), workers_, options_);
    gpu_->set_refraction(bend_per_m_);
  }
}

void EngineSwitch::lose_gpu(const std::string& reason) {
  gpu_.reset();
  lost_because_ = reason;
  watch_.lap();
  since_loss_s_ = 0.0;
  cpu();
  describe();
  report(fmt::format("engine: the GPU is lost: {}; the CPU renders from now on{}", reason,
                     options_.gpu.retry_s > 0.0
                         ? fmt::format(", and the GPU is tried again every {:g} s", options_.gpu.retry_s)
                         : ""));
}

void EngineSwitch::retry_gpu() {
  since_loss_s_ += watch_.lap();
  if (options_.gpu.retry_s <= 0.0 || since_loss_s_ < options_.gpu.retry_s) {
    return;
  }
  since_loss_s_ = 0.0;
  try {
    make_gpu();
  } catch (const RendererError&) {
    return;  // the loss was already reported
  }
  describe();
  report("engine: the GPU is back, using " + description_);
}

/// @param too_large gets the message if a request does not fit on the GPU
/// @return false if the GPU did not make the images; their statistics are then unchanged
bool EngineSwitch::images_by_gpu(std::span<const EchoJob> jobs, std::string& too_large) {
  std::vector<PingStatistics> before;
  for (const EchoJob& job : jobs) {
    before.push_back(job.statistics);
  }
  try {
    gpu_->images(jobs);
    return true;
  } catch (const RequestError& error) {
    too_large = error.what();
  } catch (const RendererError& error) {
    lose_gpu(error.what());
  }
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    jobs[i].statistics = before[i];
  }
  return false;
}

void EngineSwitch::images(std::span<const EchoJob> jobs) {
  if (wants_gpu_ && !gpu_) {
    retry_gpu();
  }
  std::string too_large;
  if (kind() == EngineKind::gpu && images_by_gpu(jobs, too_large)) {
    return;
  }
  if (!too_large.empty() && jobs.size() > 1) {
    for (const EchoJob& job : jobs) {  // one by one, so that only the request that does not fit uses the CPU
      images({&job, 1});
    }
    return;
  }
  cpu().images(jobs);
  if (!too_large.empty() && !told_too_large_) {
    told_too_large_ = true;
    report(fmt::format("engine: the GPU cannot render a ping, using the CPU: {} (logged once)", too_large));
  }
}

void EngineSwitch::set_body_pose(std::size_t body, const Pose& T_world_body) {
  for (EchoEngine* engine : {cpu_.get(), gpu_.get()}) {
    if (engine != nullptr) {
      engine->set_body_pose(body, T_world_body);
    }
  }
}

void EngineSwitch::set_part_meshes(std::span<const PartMesh> changes) {
  if (cpu_) {
    cpu_->set_part_meshes(changes);
  }
  if (gpu_) {
    try {
      gpu_->set_part_meshes(changes);
    } catch (const RendererError& error) {
      lose_gpu(error.what());
    }
  }
}

void EngineSwitch::set_refraction(double bend_per_m) {
  bend_per_m_ = bend_per_m;
  for (EchoEngine* engine : {cpu_.get(), gpu_.get()}) {
    if (engine != nullptr) {
      engine->set_refraction(bend_per_m);
    }
  }
}

void EngineSwitch::describe() {
  description_ = (kind() == EngineKind::gpu ? gpu_ : cpu_)->description();
  if (wants_gpu_ && !gpu_) {
    description_ += ", because the GPU is lost: " + lost_because_;
  }
}

void EngineSwitch::report(const std::string& line) const {
  if (options_.report) {
    options_.report(line);
  }
}

}  // namespace sonard::render
