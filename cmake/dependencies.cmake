# SPDX-License-Identifier: Apache-2.0
# Finds all libraries of the project once, for all folders. docker/packages.txt lists the packages, and
# docs/platforms.md the versions that were built.

# ---- needed -----------------------------------------------------------------------------------------------------
include(GNUInstallDirs)
find_package(assimp REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(glm REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(OpenGL REQUIRED COMPONENTS OpenGL EGL)
find_package(OpenSceneGraph REQUIRED COMPONENTS osgDB osgUtil)
find_package(PkgConfig REQUIRED)
find_package(Protobuf REQUIRED)
find_package(spdlog REQUIRED)
find_package(Threads REQUIRED)
find_package(yaml-cpp REQUIRED)
if(NOT TARGET yaml-cpp::yaml-cpp)  # before version 0.8
  add_library(yaml-cpp::yaml-cpp ALIAS yaml-cpp)
endif()
find_package(ZLIB REQUIRED)
# These have no CMake package on Ubuntu 22.04.
pkg_check_modules(PNG REQUIRED IMPORTED_TARGET libpng)
pkg_check_modules(SECCOMP REQUIRED IMPORTED_TARGET libseccomp)
pkg_check_modules(SNAPPY REQUIRED IMPORTED_TARGET snappy)
pkg_check_modules(TIFF REQUIRED IMPORTED_TARGET libtiff-4)
pkg_check_modules(TINYXML2 REQUIRED IMPORTED_TARGET tinyxml2)
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)

# Versions 3 and 4 have different functions for rays; renderer/spatial_index supports both.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 REQUIRED)
endif()

# Debian has OpenCVConfig.cmake in libopencv-dev, which depends on desktop packages; a few libraries are enough.
find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
set(parts core imgproc)
if(SONARD_TESTS)
  list(APPEND parts imgcodecs)  # tests read written files with it; it depends on GDAL and a hundred libraries more
endif()
foreach(part IN LISTS parts)
  find_library(OPENCV_${part}_LIBRARY opencv_${part} REQUIRED)
  add_library(opencv_${part} UNKNOWN IMPORTED)
  set_target_properties(opencv_${part} PROPERTIES
    IMPORTED_LOCATION ${OPENCV_${part}_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
endforeach()

# ---- optional: the daemon prints a similar message if a missing library is needed ----------------------------------
pkg_check_modules(GEOGRAPHICLIB QUIET IMPORTED_TARGET geographiclib)
if(NOT GEOGRAPHICLIB_FOUND)
  message(STATUS "Without GeographicLib (libgeographiclib-dev): world.origin, maps at their place on Earth and "
                 "GLOBAL_POSITION_INT are refused")
endif()

include(cmake/gazebo.cmake)
if(NOT TARGET sonard_gazebo)
  message(STATUS "Without Gazebo Transport (libignition-transport-dev and libignition-msgs-dev, or libgz-): "
                 "poses.gazebo is refused; sonard takes poses in every other way")
endif()

if(SONARD_TESTS)
  find_package(GTest REQUIRED)
  find_package(sdformat12 QUIET)
  if(NOT sdformat12_FOUND)
    message(STATUS "Without libsdformat 12 (libsdformat-dev): our reader of SDF is not compared with Gazebo's")
  endif()
endif()
