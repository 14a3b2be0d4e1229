// SPDX-License-Identifier: Apache-2.0
// What this machine can run OpenGL on, and which of it is taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace sonard::render {

/// A device that EGL lists.
struct GlDevice {
  std::string description;       ///< "vendor / renderer / version"; empty: OpenGL 4.5 does not run on it
  std::string node;              ///< "/dev/dri/card0"; empty: it has none
  bool software = false;         ///< as its driver says, or is_software_renderer()
  std::uint64_t memory_mib = 0;  ///< of its own; 0: none, or the driver does not tell
};

/// What there is, in the order of EGL. Where EGL cannot list devices, the surfaceless platform is the only
/// one. Makes a context on each, so it takes some tenths of a second.
std::vector<GlDevice> list_gl_devices();

/// Whether OpenGL runs on the CPU, by a description of GlDevice: llvmpipe, softpipe, swrast and their like.
bool is_software_renderer(const std::string& description);

/// The device that choose_gl_device() would take, if OpenGL runs on the CPU there; empty: it runs on a GPU,
/// or not at all. Makes contexts only if EGL lists hardware.
std::string software_gl(const std::string& wanted);

struct GlDeviceChoice {
  std::size_t number = 0;  ///< in the list
  std::string reason;      ///< "the only one"
};

/// @param wanted as GpuOptions::device. Without it hardware comes before software, then most memory, then the
/// order of the list.
/// @throws RendererError saying what there is, when none of it will do.
GlDeviceChoice choose_gl_device(const std::vector<GlDevice>& devices, const std::string& wanted);

/// "0: vendor / renderer / version, /dev/dri/card0, 8192 MiB" for each; for messages and lists.
std::vector<std::string> describe(const std::vector<GlDevice>& devices);

}  // namespace sonard::render
