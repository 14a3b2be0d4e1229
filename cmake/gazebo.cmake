# SPDX-License-Identifier: Apache-2.0
# sonard_gazebo: Gazebo's transport and messages, of the newest release that is installed. Without them there is no such
# target. Jetty (transport 15, messages 12) was the first release without version numbers in its packages' names. Until
# Fortress, packages, headers and namespaces were called ignition.
foreach(release "gz-transport gz-msgs" "gz-transport14 gz-msgs11" "gz-transport13 gz-msgs10" "gz-transport12 gz-msgs9"
        "ignition-transport11 ignition-msgs8")
  separate_arguments(release)
  list(GET release 0 transport)
  list(GET release 1 messages)
  find_package(${transport} QUIET)
  find_package(${messages} QUIET)
  if(${transport}_FOUND AND ${messages}_FOUND)
    add_library(sonard_gazebo INTERFACE)
    if(transport MATCHES "^gz-")
      target_compile_definitions(sonard_gazebo INTERFACE SONARD_GAZEBO_GZ)
    endif()
    target_link_libraries(sonard_gazebo INTERFACE ${transport}::${transport} ${messages}::${messages})
    break()
  endif()
endforeach()
