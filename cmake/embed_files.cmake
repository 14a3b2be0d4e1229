# SPDX-License-Identifier: Apache-2.0
# cmake -DOUT=FILE -DFOLDER=FOLDER -DFILES=A;B -P embed_files.cmake: writes find_asset() of server/web/assets.hpp with
# these files from the folder.
set(types ".html=text/html" ".css=text/css" ".js=text/javascript" ".svg=image/svg+xml" ".json=application/json")
set(arrays "")
set(table "")
set(number 0)
foreach(file IN LISTS FILES)
  file(READ ${FOLDER}/${file} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  get_filename_component(extension ${file} LAST_EXT)
  set(type "application/octet-stream")
  foreach(pair IN LISTS types)
    if(pair MATCHES "^${extension}=(.*)$")
      set(type "${CMAKE_MATCH_1}; charset=utf-8")
    endif()
  endforeach()
  string(APPEND arrays "constexpr unsigned char bytes_${number}[] = {${bytes}};\n")
  string(APPEND table "    {\"/${file}\", \"${type}\", view(bytes_${number})},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUT} "// Written by cmake/embed_files.cmake.
#include \"server/web/assets.hpp\"

#include <cstddef>

namespace sonard::server {
namespace {

${arrays}
template <std::size_t Size>
std::string_view view(const unsigned char (&bytes)[Size]) {
  return {reinterpret_cast<const char*>(bytes), Size};
}

const Asset assets[] = {
${table}};

}  // namespace

const Asset* find_asset(std::string_view path) {
  for (const Asset& asset : assets) {
    if (asset.path == path) {
      return &asset;
    }
  }
  return nullptr;
}

}  // namespace sonard::server
")
