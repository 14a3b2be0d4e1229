# SPDX-License-Identifier: Apache-2.0
# sonard_build_info: a header, and a Python module, with the text of --version. They are rewritten when the commit has
# changed, and only files with main() include the header.
set(SONARD_FEATURES "")
if(GEOGRAPHICLIB_FOUND)
  list(APPEND SONARD_FEATURES GeographicLib)
endif()
if(TARGET sonard_gazebo)
  list(APPEND SONARD_FEATURES "Gazebo Transport")
endif()
list(JOIN SONARD_FEATURES ", " SONARD_FEATURES)

set(SONARD_COMMIT "" CACHE STRING "The commit that --version names; empty: what git says of the source")
add_custom_target(sonard_write_build_info
  COMMAND ${CMAKE_COMMAND} -D SOURCE=${PROJECT_SOURCE_DIR} -D OUT=${PROJECT_BINARY_DIR}/build_info/sonard_build_info.hpp
          -D PYTHON=${PROJECT_BINARY_DIR}/share/sonard/python/sonard_version.py -D VERSION=${PROJECT_VERSION} -D COMMIT=${SONARD_COMMIT} -D "FEATURES=${SONARD_FEATURES}" -P ${CMAKE_CURRENT_LIST_DIR}/write_build_info.cmake
  BYPRODUCTS ${PROJECT_BINARY_DIR}/build_info/sonard_build_info.hpp ${PROJECT_BINARY_DIR}/share/sonard/python/sonard_version.py
  VERBATIM)
install(FILES ${PROJECT_BINARY_DIR}/share/sonard/python/sonard_version.py DESTINATION ${CMAKE_INSTALL_DATADIR}/sonard/python)
add_library(sonard_build_info INTERFACE)
target_include_directories(sonard_build_info INTERFACE ${PROJECT_BINARY_DIR}/build_info)
add_dependencies(sonard_build_info sonard_write_build_info)
add_dependencies(sonard_pose_python sonard_write_build_info)  # roscast needs both modules
