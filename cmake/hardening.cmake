# SPDX-License-Identifier: Apache-2.0
# Compiler options that make memory errors harder to exploit, for all targets (docs/security.md, "Builds"). Sanitizers
# replace them.
include(CheckCXXCompilerFlag)
include(CheckCXXSourceCompiles)
include(CheckLinkerFlag)
include(CheckPIESupported)

option(SONARD_HARDENING "Compile and link with stack protector, control-flow protection, _FORTIFY_SOURCE, PIE and RELRO" ON)
if(NOT SONARD_HARDENING OR SONARD_SANITIZE)
  return()
endif()

# Compilers of most distributions make PIEs by default. Their code is faster than with -fPIC, which CMake uses for
# static libraries.
check_cxx_source_compiles("
  #ifndef __PIE__
  #error
  #endif
  int main() {}" SONARD_PIE_BY_DEFAULT)
if(NOT SONARD_PIE_BY_DEFAULT)
  check_pie_supported(LANGUAGES CXX)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()

foreach(flag -fstack-protector-strong -fcf-protection)
  string(MAKE_C_IDENTIFIER "SONARD_HAS${flag}" known)
  check_cxx_compiler_flag(${flag} ${known})
  if(${known})
    add_compile_options(${flag})
  endif()
endforeach()

# Level 3 also checks sizes that are known at run time only. It needs optimisation.
check_cxx_source_compiles("
  #if !__has_builtin(__builtin_dynamic_object_size)
  #error
  #endif
  int main() {}" SONARD_HAS_DYNAMIC_OBJECT_SIZE)
set(level 2)
if(SONARD_HAS_DYNAMIC_OBJECT_SIZE)
  set(level 3)
endif()
add_compile_options($<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE> $<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=${level}>)

foreach(flag relro now)
  check_linker_flag(CXX -Wl,-z,${flag} SONARD_LINKS_${flag})
  if(SONARD_LINKS_${flag})
    add_link_options(-Wl,-z,${flag})
  endif()
endforeach()
