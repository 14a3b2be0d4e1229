# SPDX-License-Identifier: Apache-2.0
# Writes the trajectories that files of configs/ name, into configs/trajectories. Git has demo.csv only, as an example.

# Debian's interpreter, which sees the Python packages of docker/packages.txt; the first in PATH may be another one.
find_program(SONARD_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_program(SONARD_PYTHON python3 REQUIRED)

set(generator ${PROJECT_SOURCE_DIR}/configs/worlds/generate)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${generator}/generate.py ${generator}/trajectories.py)
execute_process(COMMAND ${SONARD_PYTHON} -B ${generator}/generate.py --trajectories COMMAND_ERROR_IS_FATAL ANY)
