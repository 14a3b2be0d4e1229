# SPDX-License-Identifier: Apache-2.0
# Runs at each build: -D SOURCE -D OUT -D PYTHON -D VERSION -D COMMIT -D FEATURES. Without git, as in a tarball, the
# text has no commit.
if(NOT COMMIT)
  execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
                  OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(commit "")
if(COMMIT)
  set(commit ", commit ${COMMIT}")
endif()
if(FEATURES)
  set(FEATURES ", with ${FEATURES}")
endif()

# write_if_changed(FILE TEXT)
function(write_if_changed file text)
  set(before "")
  if(EXISTS ${file})
    file(READ ${file} before)
  endif()
  if(NOT text STREQUAL before)
    file(WRITE ${file} "${text}")
  endif()
endfunction()

write_if_changed(${OUT} "// What --version prints behind the name of a program.
#define SONARD_BUILD_INFO \"${VERSION}${commit}${FEATURES}\"
")
write_if_changed(${PYTHON} "VERSION = '${VERSION}${commit}'
")
