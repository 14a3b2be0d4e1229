// SPDX-License-Identifier: Apache-2.0
// The OpenGL devices of this machine, and the choice of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace sonard::render {

/// A device that EGL lists.
struct GlDevice {
  std::string description;       ///< "vendor / renderer / version"; empty: OpenGL 4.5 does not run on it
  std::string node;              ///< "/dev/dri/card0"; empty: no node
  bool software = false;         ///< according to its driver, or is_software_renderer()
  std::uint64_t memory_mib = 0;  ///< dedicated memory; 0: not reported
};

/// All devices, in the order of EGL; only the surfaceless platform if EGL cannot list devices. Makes a
/// context on each, so it takes some tenths of a second.
std::vector<GlDevice> list_gl_devices();

/// True if OpenGL runs on the CPU (llvmpipe, softpipe, swrast ...). @param description GlDevice::description
bool is_software_renderer(const std::string& description);

/// Description of the device that choose_gl_device() chooses, if its OpenGL runs on the CPU; empty if it runs
/// on a GPU or if there is no such device. Makes contexts only if EGL lists hardware.
std::string software_gl(const std::string& wanted);

struct GlDeviceChoice {
  std::size_t number = 0;  ///< in the list
  std::string reason;      ///< "the only device"
};

/// Chooses a device: hardware before software, then most memory, then the order of the list.
/// @param wanted see GpuOptions::device; if given, only that device
/// @throws RendererError, with a list of the devices, if there is no suitable one
GlDeviceChoice choose_gl_device(const std::vector<GlDevice>& devices, const std::string& wanted);

/// "0: vendor / renderer / version, /dev/dri/card0, 8192 MiB" per device, for messages and lists.
std::vector<std::string> describe(const std::vector<GlDevice>& devices);

}  // namespace sonard::render
