// The door of the renderer: a world and a ping request go in, an echo image and the device's samples come
// out.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/backend.hpp"
#include "renderer/errors.hpp"
#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Mean echo intensity behind array and pulse, before speckle, noise and gain. Linear; mode `physical`: re
/// the source intensity at 1 m, per beam and native line; mode `paper`: the paper's I_bin in [0, 1].
struct EchoImage {
  int beams = 0;
  int lines = 0;
  std::vector<float> intensity;  ///< [beam * lines + line]

  float at(int beam, int line) const {
    return intensity[static_cast<std::size_t>(beam) * static_cast<std::size_t>(lines) +
                     static_cast<std::size_t>(line)];
  }
};

/// What the receiver hands to the device, ready to be sent: line after line, each from port to starboard.
struct PingSamples {
  int beams = 0;
  int lines = 0;                   ///< after range compression
  std::vector<std::uint8_t> u8;    ///< [line * beams + beam], when 8 bit were asked for
  std::vector<std::uint16_t> u16;  ///< the same, when 16 bit were asked for
};

struct PingRequest {
  Pose T_world_sonar;  ///< when the ping is sent
  SonarSettings settings;
  std::uint64_t ping_number = 0;  ///< enters the random numbers; never wraps
  std::uint64_t seed = 0;
  /// When the echo of the last line returns, 2 R / c later; nullopt: the sonar is at rest
  /// (docs/physics.md 2.14).
  std::optional<Pose> T_world_sonar_at_end{};
};

/// Seconds spent, and how much work there was. For logs, metrics and the benchmark.
struct PingStatistics {
  double visibility_s = 0.0;
  double binning_s = 0.0;
  double multipath_s = 0.0;
  double azimuth_pattern_s = 0.0;
  double pulse_s = 0.0;
  double receiver_s = 0.0;
  std::uint64_t samples = 0;
  std::uint64_t invalid_samples = 0;  ///< NaN or infinite: dropped
  /// Echoes beyond what the sums of GpuBinner hold, taken as that: 2^14 times unit response or more.
  std::uint64_t saturated_samples = 0;
  /// Why a fixed grid that was to be binned on the GPU was binned on the CPU; empty otherwise. One line.
  std::string gpu_binning_obstacle;
  SkipCounts skipped;  ///< what was left out; stages that did not run have counted nothing
};

/// Renders pings of one world. Every call, construction and destruction included, comes from one thread,
/// which owns the GL context if there is one. Several sonars may share one renderer; each gives its own
/// `stream` number, which keeps their speckle apart.
class SonarRenderer {
 public:
  /// @throws RendererError when what was asked for cannot be had: `raster` without OpenGL 4.5, or binning on
  /// the GPU where its shaders do not build.
  explicit SonarRenderer(const World& world, const RendererOptions& options = {});
  ~SonarRenderer();
  SonarRenderer(const SonarRenderer&) = delete;
  SonarRenderer& operator=(const SonarRenderer&) = delete;

  /// The backend in use: `raster` or `ray`.
  Backend backend() const;
  /// The same and what it runs on, in one line; where `automatic` chose, with the OpenGL it found.
  const std::string& backend_description() const;

  /// Moves a body of the world. @return false when the world has no body of that name.
  bool set_body_pose(const std::string& body_name, const Pose& T_world_body);

  /// Mean echo only: no speckle, noise or gain. The image stays valid until the next call for this stream; as
  /// long as nothing that it depends on changes (SkipRule::unchanged_scene), the same one is handed out.
  /// @throws RequestError, RendererError
  const EchoImage& render_echo(const PingRequest& request, int stream = 0);

  /// The whole chain. The result is the same bytes for the same history of requests of this stream; with
  /// speckle `frozen` or `per_ping` it depends on this request alone.
  /// @throws RequestError, RendererError
  PingSamples render_ping(const PingRequest& request, int stream = 0);

  /// Leaves all that this stream keeps from ping to ping as render_ping() would, for a fraction of its time:
  /// whoever renders every n-th ping of a run gets the bytes of the whole run.
  /// @return false, and nothing has happened, when that depends on the echo: where pulses are shorter than a
  /// line, speckle `ou` goes on only in lines with an echo. Then render_ping() it is.
  /// @throws RequestError
  bool pass_ping(const PingRequest& request, int stream = 0);

  const PingStatistics& last_statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Renders a wall with a closed-form echo and compares (docs/accuracy.md, T2), by the default preset and by a
/// fixed grid.
/// @return the larger RMS error over bins above 1e-2 of the beam's maximum.
/// @throws RendererError when the backend fails, the image is empty or the error exceeds 5 %.
double run_self_test(const RendererOptions& options = {});

}  // namespace sonard::render
