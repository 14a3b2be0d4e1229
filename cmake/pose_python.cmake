# SPDX-License-Identifier: Apache-2.0
# The Python message module of poses for publishers: ours, test programs, and programs of users with an installed
# sonard.

set(SONARD_POSE_PYTHON ${PROJECT_BINARY_DIR}/share/sonard/python)
add_custom_command(
  OUTPUT ${SONARD_POSE_PYTHON}/pose_pb2.py
  COMMAND ${CMAKE_COMMAND} -E make_directory ${SONARD_POSE_PYTHON}
  COMMAND protobuf::protoc --proto_path=${PROJECT_SOURCE_DIR}/protocol/pose --python_out=${SONARD_POSE_PYTHON} pose.proto
  DEPENDS ${PROJECT_SOURCE_DIR}/protocol/pose/pose.proto
  VERBATIM)
add_custom_target(sonard_pose_python ALL DEPENDS ${SONARD_POSE_PYTHON}/pose_pb2.py)
install(FILES ${SONARD_POSE_PYTHON}/pose_pb2.py DESTINATION ${CMAKE_INSTALL_DATADIR}/sonard/python)
