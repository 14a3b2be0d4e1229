# SPDX-License-Identifier: Apache-2.0
# The only list of the types of device, one per line. A type NAME has
#   protocol/NAME             library sonard_NAME: its bytes and its state machine
#   server/devices/NAME       library sonard_device_NAME with `const DeviceType& NAME_type()` in type.hpp
#   clients/sonarview/NAME    library sonard_view_NAME with `const Subcommand& NAME_subcommand()`
#   clients/wireshark         NAME_fields.cpp with `std::string NAME_field_tables()`, and the dissector sonard_NAME.lua with
#                             its sonard_NAME_fields.lua
# protocol/README.md explains how to add one.
set(SONARD_DEVICES
  gemini
  micron
  oculus
  ping1d
  ping360
  sonar3d15
  dvl_a50
)
