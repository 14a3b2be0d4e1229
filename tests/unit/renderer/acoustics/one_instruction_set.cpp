// SPDX-License-Identifier: Apache-2.0
// The receiver, compiled for one instruction set in its own namespace. The build compiles this file several
// times, with
//   SONARD_SIMD_CLONES  the attribute that picks the instruction set (renderer/simd.hpp)
//   sonard              the namespace, so that all versions fit into one program
//   MAKE_PINGS          name of the function that the test calls
#include "renderer/acoustics/beam_correlation.cpp"
#include "renderer/acoustics/beam_pattern.cpp"
#include "renderer/acoustics/correlated_field.cpp"
#include "renderer/acoustics/echo_block.cpp"
#include "renderer/acoustics/kept_speckle.cpp"
#include "renderer/acoustics/line_array.cpp"
#include "renderer/acoustics/noise.cpp"
#include "renderer/acoustics/paper_receiver.cpp"
#include "renderer/acoustics/physical_receiver.cpp"
#include "renderer/acoustics/point_spread.cpp"
#include "renderer/acoustics/pulse.cpp"
#include "renderer/acoustics/quantizer.cpp"
#include "renderer/acoustics/random.cpp"
#include "renderer/acoustics/receiver.cpp"
#include "renderer/acoustics/receiver_tables.cpp"
#include "renderer/acoustics/ring_down.cpp"
#include "renderer/acoustics/scanned_speckle.cpp"
#include "renderer/acoustics/speckle_field.cpp"
#include "renderer/acoustics/steady_echo.cpp"
#include "renderer/acoustics/texture.cpp"
#include "renderer/acoustics/tone.cpp"
#include "renderer/acoustics/tvg.cpp"
#include "renderer/aperture.cpp"
#include "renderer/usable_cores.cpp"
#include "renderer/worker_pool.cpp"
//
#include "tests/unit/renderer/acoustics/several_pings.hpp"

std::vector<std::uint16_t> MAKE_PINGS() {
  return several_pings<sonard::render::Receiver, sonard::render::PointSpread, sonard::render::PingRequest,
                       sonard::render::EchoImage, sonard::render::WorkerPool>();
}
