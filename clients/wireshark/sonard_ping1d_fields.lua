-- Made by wireshark_fields from protocol/ping1d/layout.hpp; not to be edited.
-- A field is { offset, size in bytes, name, number of values if there are several }, little-endian.
return {
  commands = {
    [6] = "general_request",
    [100] = "set_common_device_id",
    [1000] = "set_device_id",
    [1001] = "set_range",
    [1002] = "set_speed_of_sound",
    [1003] = "set_mode_auto",
    [1004] = "set_ping_interval",
    [1005] = "set_gain_setting",
    [1006] = "set_ping_enable",
    [1100] = "goto_bootloader",
    [1400] = "continuous_start",
    [1401] = "continuous_stop",
  },
  reports = {
    [1] = "ack",
    [2] = "nack",
    [3] = "ascii_text",
    [4] = "device_information",
    [5] = "protocol_version",
    [1200] = "firmware_version",
    [1201] = "device_id",
    [1202] = "voltage_5",
    [1203] = "speed_of_sound",
    [1204] = "range",
    [1205] = "mode_auto",
    [1206] = "ping_interval",
    [1207] = "gain_setting",
    [1208] = "transmit_duration",
    [1210] = "general_info",
    [1211] = "distance_simple",
    [1212] = "distance",
    [1213] = "processor_temperature",
    [1214] = "pcb_temperature",
    [1215] = "ping_enable",
    [1300] = "profile",
  },
  messages = {
    general_request = { size = 10, minimum = 10, fields = {
      { 8, 2, "requested_id" },
    } },
    set_common_device_id = { size = 9, minimum = 9, fields = {
      { 8, 1, "device_id" },
    } },
    set_device_id = { size = 9, minimum = 9, fields = {
      { 8, 1, "device_id" },
    } },
    set_range = { size = 16, minimum = 16, fields = {
      { 8, 4, "scan_start" },
      { 12, 4, "scan_length" },
    } },
    set_speed_of_sound = { size = 12, minimum = 12, fields = {
      { 8, 4, "speed_of_sound" },
    } },
    set_mode_auto = { size = 9, minimum = 9, fields = {
      { 8, 1, "mode_auto" },
    } },
    set_ping_interval = { size = 10, minimum = 10, fields = {
      { 8, 2, "ping_interval" },
    } },
    set_gain_setting = { size = 9, minimum = 9, fields = {
      { 8, 1, "gain_setting" },
    } },
    set_ping_enable = { size = 9, minimum = 9, fields = {
      { 8, 1, "ping_enabled" },
    } },
    continuous_start = { size = 10, minimum = 10, fields = {
      { 8, 2, "id" },
    } },
    continuous_stop = { size = 10, minimum = 10, fields = {
      { 8, 2, "id" },
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
    firmware_version = { size = 14, minimum = 14, fields = {
      { 8, 1, "device_type" },
      { 9, 1, "device_model" },
      { 10, 2, "firmware_version_major" },
      { 12, 2, "firmware_version_minor" },
    } },
    device_id = { size = 9, minimum = 9, fields = {
      { 8, 1, "device_id" },
    } },
    voltage_5 = { size = 10, minimum = 10, fields = {
      { 8, 2, "voltage_5" },
    } },
    speed_of_sound = { size = 12, minimum = 12, fields = {
      { 8, 4, "speed_of_sound" },
    } },
    range = { size = 16, minimum = 16, fields = {
      { 8, 4, "scan_start" },
      { 12, 4, "scan_length" },
    } },
    mode_auto = { size = 9, minimum = 9, fields = {
      { 8, 1, "mode_auto" },
    } },
    ping_interval = { size = 10, minimum = 10, fields = {
      { 8, 2, "ping_interval" },
    } },
    gain_setting = { size = 12, minimum = 12, fields = {
      { 8, 4, "gain_setting" },
    } },
    transmit_duration = { size = 10, minimum = 10, fields = {
      { 8, 2, "transmit_duration" },
    } },
    general_info = { size = 18, minimum = 18, fields = {
      { 8, 2, "firmware_version_major" },
      { 10, 2, "firmware_version_minor" },
      { 12, 2, "voltage_5" },
      { 14, 2, "ping_interval" },
      { 16, 1, "gain_setting" },
      { 17, 1, "mode_auto" },
    } },
    distance_simple = { size = 13, minimum = 13, fields = {
      { 8, 4, "distance" },
      { 12, 1, "confidence" },
    } },
    distance = { size = 32, minimum = 32, fields = {
      { 8, 4, "distance" },
      { 12, 2, "confidence" },
      { 14, 2, "transmit_duration" },
      { 16, 4, "ping_number" },
      { 20, 4, "scan_start" },
      { 24, 4, "scan_length" },
      { 28, 4, "gain_setting" },
    } },
    processor_temperature = { size = 10, minimum = 10, fields = {
      { 8, 2, "processor_temperature" },
    } },
    pcb_temperature = { size = 10, minimum = 10, fields = {
      { 8, 2, "pcb_temperature" },
    } },
    ping_enable = { size = 9, minimum = 9, fields = {
      { 8, 1, "ping_enabled" },
    } },
    profile = { size = 32, minimum = 32, fields = {
      { 8, 4, "distance" },
      { 12, 2, "confidence" },
      { 14, 2, "transmit_duration" },
      { 16, 4, "ping_number" },
      { 20, 4, "scan_start" },
      { 24, 4, "scan_length" },
      { 28, 4, "gain_setting" },
    } },
  },
}
