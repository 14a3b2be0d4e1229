# SPDX-License-Identifier: Apache-2.0
find_package(Protobuf REQUIRED)

# The example publisher runs as a user would run it: message module by protoc, sockets of Python's own.
set(SONARD_POSE_PYTHON ${PROJECT_BINARY_DIR}/pose_python)
add_custom_command(
  OUTPUT ${SONARD_POSE_PYTHON}/pose_pb2.py
  COMMAND ${CMAKE_COMMAND} -E make_directory ${SONARD_POSE_PYTHON}
  COMMAND protobuf::protoc --proto_path=${PROJECT_SOURCE_DIR}/protocol/pose --python_out=${SONARD_POSE_PYTHON} pose.proto
  DEPENDS ${PROJECT_SOURCE_DIR}/protocol/pose/pose.proto
  VERBATIM)
add_custom_target(sonard_pose_python DEPENDS ${SONARD_POSE_PYTHON}/pose_pb2.py)
