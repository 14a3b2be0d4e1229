# SPDX-License-Identifier: Apache-2.0
# cmake -DOUT=FILE -DFOLDER=FOLDER -DFILES=A;B -P embed_shaders.cmake: writes a header with these files from the folder
# as strings. gpu/see.comp becomes see_comp, with the files that its lines #include, each once.
cmake_policy(VERSION 3.22)

function(expand file result)
  file(READ ${FOLDER}/${file} text)
  set(included "")
  while(text MATCHES "#include \"([^\"]*)\"\n")
    set(line "${CMAKE_MATCH_0}")
    set(part "")
    if(NOT CMAKE_MATCH_1 IN_LIST included)
      list(APPEND included ${CMAKE_MATCH_1})
      file(READ ${FOLDER}/${CMAKE_MATCH_1} part)
    endif()
    string(FIND "${text}" "${line}" begin)
    string(LENGTH "${line}" length)
    math(EXPR end "${begin} + ${length}")
    string(SUBSTRING "${text}" 0 ${begin} before)
    string(SUBSTRING "${text}" ${end} -1 after)
    set(text "${before}${part}${after}")
  endwhile()
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

set(texts "")
foreach(file IN LISTS FILES)
  expand(${file} text)
  get_filename_component(name ${file} NAME)
  string(REPLACE "." "_" name ${name})
  string(APPEND texts "inline constexpr char ${name}[] = R\"glsl(${text})glsl\";\n")
endforeach()
file(WRITE ${OUT} "// Written by cmake/embed_shaders.cmake.
#pragma once

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored \"-Woverlength-strings\"  // compilers need not take more than 65536 characters

namespace sonard::render::shaders {

${texts}
}  // namespace sonard::render::shaders

#pragma GCC diagnostic pop
")
