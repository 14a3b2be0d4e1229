# SPDX-License-Identifier: Apache-2.0
# cmake -DOUT=FILE -DFOLDER=FOLDER -DFILES=A;B -P embed_shaders.cmake: writes a header with these files from the folder
# as strings. cut.glsl becomes cut_glsl, without its folder.
set(texts "")
foreach(file IN LISTS FILES)
  file(READ ${FOLDER}/${file} text)
  get_filename_component(name ${file} NAME)
  string(REPLACE "." "_" name ${name})
  string(APPEND texts "inline constexpr char ${name}[] = R\"glsl(${text})glsl\";\n")
endforeach()
file(WRITE ${OUT} "// Written by cmake/embed_shaders.cmake.
#pragma once

namespace sonard::render::shaders {

${texts}
}  // namespace sonard::render::shaders
")
