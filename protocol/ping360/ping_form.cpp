// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/ping_form.hpp"

#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {

PingForm form_of(const Transducer& command) {
  PingForm form;
  copy_ping_settings(form.settings, command);
  form.settings.angle = static_cast<std::uint16_t>(wrapped(command.angle));
  return form;
}

PingForm form_of(const AutoTransmit& command, int angle) {
  PingForm form;
  copy_ping_settings(form.settings, command);
  form.settings.angle = static_cast<std::uint16_t>(angle);
  form.scan = command;
  return form;
}

std::optional<PingForm> form_of(const Report& report) {
  if (const auto* const data = std::get_if<DeviceData>(&report)) {
    PingForm form{*data, std::nullopt};
    form.settings.data = {};
    return form;
  }
  if (const auto* const data = std::get_if<AutoDeviceData>(&report)) {
    AutoTransmit scan;
    copy_ping_settings(scan, *data);
    copy_scan_settings(scan, *data);
    return form_of(scan, data->angle);
  }
  return std::nullopt;
}

Report message_of(const PingForm& form, std::span<const std::uint8_t> data) {
  if (!form.scan) {
    DeviceData message = form.settings;
    message.data = data;
    return message;
  }
  AutoDeviceData message;
  copy_ping_settings(message, form.settings);
  copy_scan_settings(message, *form.scan);
  message.angle = form.settings.angle;
  message.data = data;
  return message;
}

}  // namespace sonard::ping360
