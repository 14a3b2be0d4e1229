# SPDX-License-Identifier: Apache-2.0
# Compiler options of all targets of this project. Third-party headers are included as SYSTEM.
add_library(sonard_flags INTERFACE)
target_include_directories(sonard_flags INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
target_include_directories(sonard_flags SYSTEM INTERFACE ${PROJECT_SOURCE_DIR}/cmake/compile_once)
target_compile_options(sonard_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wnon-virtual-dtor -Wold-style-cast -Wcast-qual -Wformat=2 -Werror
  # With fused multiply-add, images would depend on the machine (renderer/simd.hpp).
  -ffp-contract=off
  # Allows vectorised loops with a square root or a choice between floats. No code uses errno or traps of them.
  -fno-math-errno -fno-trapping-math
  # GCC before 14 reports false positives of these in optimised standard library code.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-error=maybe-uninitialized -Wno-error=array-bounds -Wno-error=stringop-overflow>)
set(SONARD_SIMD "" CACHE STRING "Compile hot loops for sse2, avx2 or avx512f alone; empty: for all, the best is picked at load time")
set_property(CACHE SONARD_SIMD PROPERTY STRINGS "" sse2 avx2 avx512f)
if(SONARD_SIMD)
  target_compile_definitions(sonard_flags INTERFACE SONARD_SIMD_ONLY="${SONARD_SIMD}")
endif()
if(CMAKE_UNITY_BUILD)
  # In unity builds, GCC treats a source that another one includes as a header, and names local to one source as globals
  # of all. clang's -Wshadow cannot exclude such names.
  target_compile_options(sonard_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage -Wshadow=local>)
else()
  target_compile_options(sonard_flags INTERFACE -Wshadow)
endif()
if(SONARD_SANITIZE)
  target_compile_options(sonard_flags INTERFACE -fsanitize=${SONARD_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  # This check opens a pipe to test whether memory is readable, so it fails if no descriptor is left. Tests of the
  # serial link cause this on purpose.
  target_compile_options(sonard_flags INTERFACE -fno-sanitize=vptr)
  # GCC's thread sanitizer does not model the fences around Boost.Asio's handlers, which also synchronise by mutex.
  target_compile_options(sonard_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-tsan>)
  target_link_options(sonard_flags INTERFACE -fsanitize=${SONARD_SANITIZE})
endif()

# sonard_library(NAME SOURCES...) and sonard_program(NAME SOURCES...)
function(sonard_library name)
  add_library(${name} STATIC ${ARGN})
  # Users of an installed library choose their own warnings.
  target_link_libraries(${name} PUBLIC $<BUILD_INTERFACE:sonard_flags>)
endfunction()

function(sonard_program name)
  add_executable(${name} ${ARGN})
  target_link_libraries(${name} PRIVATE sonard_flags)
endfunction()

# sonard_fuzzed(NAME): coverage feedback for libFuzzer, whose main() only the fuzz programs link (tests/fuzz).
function(sonard_fuzzed name)
  if(SONARD_FUZZ)
    target_compile_options(${name} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# sonard_proto_library(NAME PROTO IMPORTED...): the generated code of PROTO.proto, a path in the source tree, and the
# libraries of the files that it imports. It is a separate target without our warnings, and its header is SYSTEM.
function(sonard_proto_library name proto)
  set(generated ${PROJECT_BINARY_DIR}/generated)
  add_custom_command(
    OUTPUT ${generated}/${proto}.pb.cc ${generated}/${proto}.pb.h
    COMMAND ${CMAKE_COMMAND} -E make_directory ${generated}
    COMMAND protobuf::protoc --proto_path=${PROJECT_SOURCE_DIR} --cpp_out=${generated} ${proto}.proto
    DEPENDS ${PROJECT_SOURCE_DIR}/${proto}.proto
    VERBATIM)
  add_library(${name} STATIC ${generated}/${proto}.pb.cc ${generated}/${proto}.pb.h)
  target_include_directories(${name} SYSTEM PUBLIC $<BUILD_INTERFACE:${generated}>)
  set_target_properties(${name} PROPERTIES GENERATED_HEADER ${generated}/${proto}.pb.h)
  target_link_libraries(${name} PUBLIC protobuf::libprotobuf ${ARGN})
  if(SONARD_SANITIZE)
    target_compile_options(${name} PRIVATE -fsanitize=${SONARD_SANITIZE} -fno-omit-frame-pointer)
  endif()
endfunction()
