-- Made by wireshark_fields from protocol/dvl_a50/layout.hpp; not to be edited.
-- A field is { offset, size in bytes, name, number of values if there are several }, little-endian.
return {
  messages = {
    pd4 = { size = 47, minimum = 47, fields = {
      { 0, 1, "id" },
      { 1, 1, "structure" },
      { 2, 2, "size" },
      { 4, 1, "system" },
      { 5, 2, "velocity_mmps", 4 },
      { 13, 2, "range_cm", 4 },
      { 21, 1, "bottom_status" },
      { 35, 1, "clock", 4 },
      { 41, 2, "sound_speed_mps" },
      { 45, 2, "checksum" },
    } },
  },
}
