-- Made by wireshark_fields from protocol/ping360/layout.hpp; not to be edited.
-- A field is { offset, size in bytes, name, number of values if there are several }, little-endian.
return {
  commands = {
    [6] = "general_request",
    [100] = "set_common_device_id",
    [2000] = "set_device_id",
    [2600] = "reset",
    [2601] = "transducer",
    [2602] = "auto_transmit",
    [2903] = "motor_off",
  },
  reports = {
    [1] = "ack",
    [2] = "nack",
    [3] = "ascii_text",
    [4] = "device_information",
    [5] = "protocol_version",
    [2000] = "set_device_id",
    [2300] = "device_data",
    [2301] = "auto_device_data",
  },
  messages = {
    general_request = { size = 10, minimum = 10, fields = {
      { 8, 2, "requested_id" },
    } },
    set_common_device_id = { size = 9, minimum = 9, fields = {
      { 8, 1, "device_id" },
    } },
    set_device_id = { size = 10, minimum = 10, fields = {
      { 8, 1, "id" },
    } },
    reset = { size = 10, minimum = 10, fields = {
      { 8, 1, "bootloader" },
    } },
    transducer = { size = 22, minimum = 22, fields = {
      { 8, 1, "mode" },
      { 9, 1, "gain_setting" },
      { 10, 2, "angle" },
      { 12, 2, "transmit_duration" },
      { 14, 2, "sample_period" },
      { 16, 2, "transmit_frequency" },
      { 18, 2, "number_of_samples" },
      { 20, 1, "transmit" },
    } },
    auto_transmit = { size = 24, minimum = 24, fields = {
      { 8, 1, "mode" },
      { 9, 1, "gain_setting" },
      { 10, 2, "transmit_duration" },
      { 12, 2, "sample_period" },
      { 14, 2, "transmit_frequency" },
      { 16, 2, "number_of_samples" },
      { 18, 2, "start_angle" },
      { 20, 2, "stop_angle" },
      { 22, 1, "num_steps" },
      { 23, 1, "delay" },
    } },
    ack = { size = 10, minimum = 10, fields = {
      { 8, 2, "acked_id" },
    } },
    nack = { size = 10, minimum = 10, fields = {
      { 8, 2, "nacked_id" },
    } },
    device_information = { size = 14, minimum = 14, fields = {
      { 8, 1, "device_type" },
      { 9, 1, "device_revision" },
      { 10, 1, "firmware_version_major" },
      { 11, 1, "firmware_version_minor" },
      { 12, 1, "firmware_version_patch" },
    } },
    protocol_version = { size = 12, minimum = 12, fields = {
      { 8, 1, "version_major" },
      { 9, 1, "version_minor" },
      { 10, 1, "version_patch" },
    } },
    device_data = { size = 20, minimum = 20, fields = {
      { 8, 1, "mode" },
      { 9, 1, "gain_setting" },
      { 10, 2, "angle" },
      { 12, 2, "transmit_duration" },
      { 14, 2, "sample_period" },
      { 16, 2, "transmit_frequency" },
      { 18, 2, "number_of_samples" },
    } },
    auto_device_data = { size = 26, minimum = 26, fields = {
      { 8, 1, "mode" },
      { 9, 1, "gain_setting" },
      { 10, 2, "angle" },
      { 12, 2, "transmit_duration" },
      { 14, 2, "sample_period" },
      { 16, 2, "transmit_frequency" },
      { 18, 2, "start_angle" },
      { 20, 2, "stop_angle" },
      { 22, 1, "num_steps" },
      { 23, 1, "delay" },
      { 24, 2, "number_of_samples" },
    } },
  },
}
