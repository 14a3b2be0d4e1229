# SPDX-License-Identifier: Apache-2.0
# protocol/ as a package of libraries: `cmake --install BUILD --component protocol --prefix PREFIX`.
include(CMakePackageConfigHelpers)

# sonard_protocol_package(ROOMS...): each room's library is sonard::protocol_ROOM of the CMake package sonard-protocol,
# and sonard-protocol-ROOM of pkg-config. Its dependencies come from the links of its target.
function(sonard_protocol_package)
  set(include_folder ${CMAKE_INSTALL_INCLUDEDIR}/sonard)
  set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/sonard-protocol)
  set(component COMPONENT protocol EXCLUDE_FROM_ALL)
  set(rooms_of_package "")
  # From the folder of a .pc file to the prefix, so that the folder can be moved.
  file(RELATIVE_PATH PREFIX_FROM_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" PREFIX_FROM_PC ${PREFIX_FROM_PC})
  add_custom_target(sonard_protocol)  # builds everything that is installed

  foreach(room IN LISTS ARGN)
    set(targets sonard_${room})
    if(TARGET sonard_${room}_proto)
      list(APPEND targets sonard_${room}_proto)
      install(FILES $<TARGET_PROPERTY:sonard_${room}_proto,GENERATED_HEADER>
              DESTINATION ${include_folder}/protocol/${room} ${component})
    endif()
    set(needed_targets)
    set(needed_packages)
    set(link_flags)
    foreach(target IN LISTS targets)
      target_compile_features(${target} INTERFACE $<INSTALL_INTERFACE:cxx_std_20>)
      string(REPLACE sonard_ protocol_ name ${target})
      set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
      add_library(sonard::${name} ALIAS ${target})
      string(APPEND link_flags " -l${target}")
      get_target_property(links ${target} LINK_LIBRARIES)
      foreach(link IN LISTS links)
        if(link STREQUAL "ZLIB::ZLIB")
          list(APPEND needed_targets ${link})
          list(APPEND needed_packages zlib)
        elseif(link STREQUAL "PkgConfig::ZSTD")
          list(APPEND needed_targets ${link})
          list(APPEND needed_packages libzstd)
        elseif(link STREQUAL "PkgConfig::SNAPPY")
          list(APPEND needed_targets ${link})
          list(APPEND needed_packages snappy)
        elseif(link STREQUAL "nlohmann_json::nlohmann_json")
          list(APPEND needed_targets ${link})
          list(APPEND needed_packages nlohmann_json)
        elseif(link STREQUAL "fmt::fmt")
          list(APPEND needed_targets ${link})
          list(APPEND needed_packages fmt)
        elseif(link STREQUAL "protobuf::libprotobuf")
          list(APPEND needed_targets ${link})
          list(APPEND needed_packages protobuf)
        elseif(link MATCHES "^sonard_([a-z0-9]+)(_proto)?$" AND NOT CMAKE_MATCH_1 STREQUAL room)
          list(APPEND needed_packages sonard-protocol-${CMAKE_MATCH_1})
        endif()
      endforeach()
    endforeach()
    list(REMOVE_DUPLICATES needed_packages)
    list(JOIN needed_packages " " needed_packages)

    add_dependencies(sonard_protocol ${targets})
    install(TARGETS ${targets} EXPORT sonard-protocol-targets
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} ${component}
            INCLUDES DESTINATION ${include_folder})
    install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/${room} DESTINATION ${include_folder}/protocol ${component}
            FILES_MATCHING PATTERN "*.hpp" PATTERN "*.proto")
    configure_file(${PROJECT_SOURCE_DIR}/cmake/sonard-protocol.pc.in sonard-protocol-${room}.pc @ONLY)
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/sonard-protocol-${room}.pc
            DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig ${component})
    string(APPEND rooms_of_package "sonard_protocol_room(${room} ${needed_targets})\n")
  endforeach()

  install(EXPORT sonard-protocol-targets NAMESPACE sonard:: DESTINATION ${package_folder} ${component})
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/sonard-protocol-config.cmake.in sonard-protocol-config.cmake
    INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
  write_basic_package_version_file(sonard-protocol-config-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/sonard-protocol-config.cmake
                ${CMAKE_CURRENT_BINARY_DIR}/sonard-protocol-config-version.cmake
          DESTINATION ${package_folder} ${component})
endfunction()
