// SPDX-License-Identifier: Apache-2.0
// What only types of device with .glf logs have.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocol/glf/records.hpp"
#include "server/heads/head_type.hpp"

namespace sonard::server {

/// A HeadType of this class has .glf logs.
class GlfDevice {
 public:
  GlfDevice() = default;
  virtual ~GlfDevice() = default;
  GlfDevice(const GlfDevice&) = delete;
  GlfDevice& operator=(const GlfDevice&) = delete;

  /// Converts a status message to the fields of a .glf, except Origin; nullopt for other messages.
  virtual std::optional<glf::StatusRecord> glf_status(std::span<const std::uint8_t> message) const = 0;
};

/// Null if heads of this type have no .glf logs.
inline const GlfDevice* glf_device(const HeadType& type) {
  return dynamic_cast<const GlfDevice*>(&type);
}

}  // namespace sonard::server
