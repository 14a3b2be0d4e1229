# SPDX-License-Identifier: Apache-2.0
# Run at every build: -D SOURCE -D OUT -D VERSION -D COMMIT -D FEATURES. Without git, as from a tarball, no commit is named.
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
set(text "// What --version prints behind the name of a program.
#define SONARD_BUILD_INFO \"${VERSION}${commit}${FEATURES}\"
")
set(before "")
if(EXISTS ${OUT})
  file(READ ${OUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUT} "${text}")
endif()
