-- Made by wireshark_fields from protocol/sonar3d15/layout.hpp; not to be edited.
-- A field is { offset, size in bytes, name, number of values if there are several }, little-endian.
return {
  reports = {
    [827345234] = "RIP1",
    [844122450] = "RIP2",
  },
  messages = {
    packet = { size = 8, minimum = 8, fields = {
      { 0, 4, "id" },
      { 4, 4, "length" },
    } },
  },
}
