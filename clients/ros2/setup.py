# SPDX-License-Identifier: Apache-2.0
from setuptools import setup

setup(
    name="sonard_ros2",
    version="0.2.0",
    packages=["sonard_ros2", "sonard_ros2.heads"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/sonard_ros2"]),
        ("share/sonard_ros2", ["package.xml"]),
        ("share/sonard_ros2/launch", ["launch/sonard.launch.py"]),
    ],
    install_requires=["setuptools", "numpy", "sonard-client"],
    zip_safe=True,
    maintainer="sonard",
    maintainer_email="sonard@users.noreply.github.com",
    description="Poses from ROS 2 to sonard, and pings of sonard or of a real sonar to ROS 2",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "pose_bridge = sonard_ros2.pose_bridge:main",
            "sonar_bridge = sonard_ros2.sonar_bridge:main",
        ],
    },
)
