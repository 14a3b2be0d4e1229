# SPDX-License-Identifier: Apache-2.0
# sonard_list_source(FILE.cpp HEADER path NAMESPACE namespace FUNCTION name TYPE type ENTRY text
#                    [INCLUDE path | DECLARE text] NAMES names...)
# Writes FILE.cpp into the build folder of the caller. It defines `std::span<const type> name()`, which HEADER declares,
# with an entry for each of NAMES, in this order. In ENTRY, INCLUDE and DECLARE the word NAME stands for the name. The
# entries use INCLUDE, a header for each name, or DECLARE, a function of each name.
function(sonard_list_source file)
  cmake_parse_arguments(PARSE_ARGV 1 of "" "HEADER;NAMESPACE;FUNCTION;TYPE;ENTRY;INCLUDE;DECLARE" "NAMES")
  set(includes "")
  set(declarations "")
  set(entries "")
  foreach(name ${of_NAMES})
    if(of_INCLUDE)
      string(REPLACE NAME ${name} include "#include \"${of_INCLUDE}\"\n")
      string(APPEND includes "${include}")
    endif()
    if(of_DECLARE)
      string(REPLACE NAME ${name} declaration "${of_DECLARE}")
      string(APPEND declarations "${declaration};\n")
    endif()
    string(REPLACE NAME ${name} entry "${of_ENTRY}")
    list(APPEND entries "${entry}")
  endforeach()
  list(JOIN entries ", " entries)
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT
"#include \"@of_HEADER@\"

#include <array>

@includes@
namespace @of_NAMESPACE@ {

@declarations@
std::span<const @of_TYPE@> @of_FUNCTION@() {
  static const std::array entries{@entries@};
  return entries;
}

}  // namespace @of_NAMESPACE@
")
endfunction()
