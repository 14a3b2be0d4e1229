# SPDX-License-Identifier: Apache-2.0
"""Makes ROS 2 messages of their contents (sonard_client.ros2_messages)."""

from array import array
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from marine_acoustic_msgs.msg import PingInfo, ProjectedSonarImage, SonarImageData
from sensor_msgs.msg import CameraInfo, Image, LaserScan, PointCloud2, PointField, Range
from sonard_client.ros2_messages import Content
from std_msgs.msg import Header

_CLASSES = {
    "builtin_interfaces/Time": Time, "geometry_msgs/Quaternion": Quaternion, "geometry_msgs/Transform": Transform,
    "geometry_msgs/TransformStamped": TransformStamped, "geometry_msgs/Vector3": Vector3,
    "marine_acoustic_msgs/PingInfo": PingInfo, "marine_acoustic_msgs/ProjectedSonarImage": ProjectedSonarImage,
    "marine_acoustic_msgs/SonarImageData": SonarImageData, "sensor_msgs/CameraInfo": CameraInfo,
    "sensor_msgs/Image": Image, "sensor_msgs/LaserScan": LaserScan, "sensor_msgs/PointCloud2": PointCloud2,
    "sensor_msgs/PointField": PointField, "sensor_msgs/Range": Range, "std_msgs/Header": Header}


def message(value: Any) -> Any:
    """The message of a content. Arrays are passed as array.array, which messages take unchanged. Messages check the numbers of
    any other sequence one by one, and a ping has half a million."""
    if isinstance(value, Content):
        return _CLASSES[value.kind](**{name: message(field) for name, field in value.fields.items()})
    if isinstance(value, np.ndarray):
        return array(value.dtype.char, value.tobytes())
    if isinstance(value, list):
        return [message(one) for one in value]
    return value
