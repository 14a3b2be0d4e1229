# SPDX-License-Identifier: Apache-2.0
# Registers all tests of this project. A label (unit, gl, system, deep, soak, logs, simulators, cluster, release) is a part of
# ./test. The target LABEL_tests builds all programs that the tests of this label start.

foreach(label unit gl system deep soak logs simulators cluster release)
  add_custom_target(${label}_tests)
endforeach()

# Compiles in a quarter less time than -O2, and runs hardly slower, because most time is spent in the libraries. With
# sanitizers, -O0 would save less compile time than it costs at run time.
set(SONARD_TEST_OPTIMISATION -O1)

# Compiles headers that all test programs include only once. Sources still include the headers that they use.
file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/generated/test_pch.cpp CONTENT "")
add_library(sonard_test_pch OBJECT ${PROJECT_BINARY_DIR}/generated/test_pch.cpp)
target_link_libraries(sonard_test_pch PRIVATE sonard_flags GTest::gmock)
target_compile_options(sonard_test_pch PRIVATE $<$<CONFIG:RelWithDebInfo>:${SONARD_TEST_OPTIMISATION}>)
target_precompile_headers(sonard_test_pch PRIVATE
  <gmock/gmock.h> <gtest/gtest.h>
  <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <numeric> <optional> <span>
  <string> <utility> <variant> <vector>)

# sonard_patience(TEST): with sanitizers, allows five times the time.
function(sonard_patience test)
  if(SONARD_SANITIZE)
    get_test_property(${test} TIMEOUT seconds)
    math(EXPR seconds "5 * ${seconds}")
    set_tests_properties(${test} PROPERTIES TIMEOUT ${seconds})
  endif()
endfunction()

# sonard_test(NAME LABEL SOURCES... LIBS libs...): one test program as one case of CTest, because starting a process
# takes longer than most of its cases.
function(sonard_test name label)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" "LIBS")
  sonard_program(${name} ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PRIVATE ${arg_LIBS} GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE SONARD_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_compile_options(${name} PRIVATE $<$<CONFIG:RelWithDebInfo>:${SONARD_TEST_OPTIMISATION}>)
  target_precompile_headers(${name} REUSE_FROM sonard_test_pch)
  add_dependencies(${label}_tests ${name})
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT 600)
  sonard_patience(${name})
endfunction()

# sonard_python_cases(OUT SCRIPT): the cases of a unittest script, each as Class.test_method, read from its text. Cases
# inherited from a class in another file are not found.
function(sonard_python_cases out script)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${script})
  file(STRINGS ${script} lines REGEX "^(class [A-Za-z0-9_]+|    def test_[A-Za-z0-9_]+)")
  set(cases)
  foreach(line IN LISTS lines)
    if(line MATCHES "^class ([A-Za-z0-9_]+)")
      set(class ${CMAKE_MATCH_1})
    elseif(line MATCHES "def (test_[A-Za-z0-9_]+)")
      list(APPEND cases ${class}.${CMAKE_MATCH_1})
    endif()
  endforeach()
  set(${out} ${cases} PARENT_SCOPE)
endfunction()

# sonard_python_test(PREFIX LABEL SCRIPT [WHOLE] [ARGUMENTS args...] [CASES | EXCEPT cases...] [DEPENDS targets...]
#                    [PROPERTIES properties...])
# A test in Python. Each case (all, or CASES, or all EXCEPT some) is one case of CTest, so that a failure has a name:
# PREFIX.Class.test_method, without the class if the script has only one. WHOLE makes one case, PREFIX, for scripts
# whose start takes longer than their cases. DEPENDS lists the programs that the test starts.
function(sonard_python_test prefix label script)
  cmake_parse_arguments(PARSE_ARGV 3 arg "WHOLE" "" "ARGUMENTS;CASES;EXCEPT;DEPENDS;PROPERTIES")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "sonard_python_test(${prefix}) does not know: ${arg_UNPARSED_ARGUMENTS}")
  endif()
  set(script ${CMAKE_CURRENT_SOURCE_DIR}/${script})
  set(command ${SONARD_PYTHON} -B ${script} ${arg_ARGUMENTS})
  if(arg_DEPENDS)
    add_dependencies(${label}_tests ${arg_DEPENDS})
  endif()
  if(arg_WHOLE)
    add_test(NAME ${prefix} COMMAND ${command})
    set_tests_properties(${prefix} PROPERTIES LABELS ${label} TIMEOUT 120 ${arg_PROPERTIES})
    sonard_patience(${prefix})
    return()
  endif()

  sonard_python_cases(all ${script})
  foreach(case IN LISTS arg_CASES arg_EXCEPT)
    if(NOT case IN_LIST all)
      message(FATAL_ERROR "${script} has no case ${case}")
    endif()
  endforeach()
  set(cases ${all})
  if(arg_CASES)
    set(cases ${arg_CASES})
  endif()
  list(REMOVE_ITEM cases ${arg_EXCEPT})
  list(TRANSFORM all REPLACE "\\..*" "" OUTPUT_VARIABLE classes)
  list(REMOVE_DUPLICATES classes)
  list(LENGTH classes class_count)
  foreach(case IN LISTS cases)
    set(name ${prefix}.${case})
    if(class_count EQUAL 1)
      string(REPLACE "${prefix}.${classes}." "${prefix}." name ${name})
    endif()
    add_test(NAME ${name} COMMAND ${command} ${case})
    set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT 120 ${arg_PROPERTIES})
    sonard_patience(${name})
  endforeach()
endfunction()

# sonard_npm(NAME LABEL FOLDER FILES... [OPTIONS options...]): copies FILES into FOLDER of the build tree. There, the
# test NAME_npm_install installs the packages that their package-lock.json pins, from the registry that npm is
# configured for. Tests that need the packages set FIXTURES_REQUIRED NAME_node_modules.
function(sonard_npm name label folder)
  cmake_parse_arguments(PARSE_ARGV 3 arg "" "" "OPTIONS")
  foreach(file IN LISTS arg_UNPARSED_ARGUMENTS)
    configure_file(${file} ${folder}/${file} COPYONLY)
  endforeach()
  add_test(NAME ${name}_npm_install
    COMMAND npm ci --ignore-scripts --no-audit --no-fund ${arg_OPTIONS}
    WORKING_DIRECTORY ${folder})
  set_tests_properties(${name}_npm_install PROPERTIES LABELS ${label} TIMEOUT 120 FIXTURES_SETUP ${name}_node_modules)
endfunction()
