// SPDX-License-Identifier: Apache-2.0
// The part of a head's configuration that its type of device made, as an object of that type.
#pragma once

#include <stdexcept>
#include <string>
#include <typeinfo>

#include <boost/core/demangle.hpp>

#include "server/heads/head_config.hpp"

namespace sonard::server {

/// @throws std::logic_error with the names of both classes if the object is missing or of another class,
/// which is a programming error
template <class To, class From>
const To& checked_cast(const From* object) {
  if (const auto* const cast = dynamic_cast<const To*>(object)) {
    return *cast;
  }
  throw std::logic_error("expected " + boost::core::demangle(typeid(To).name()) + ", got " +
                         (object == nullptr ? "nothing" : boost::core::demangle(typeid(*object).name())));
}

/// The settings that a head's type of device has read.
/// @throws std::logic_error if the head has settings of another type of device
template <class Settings>
const Settings& device_settings(const HeadConfig& head) {
  return checked_cast<Settings>(head.device.get());
}

}  // namespace sonard::server
