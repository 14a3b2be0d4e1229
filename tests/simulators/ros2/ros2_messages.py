# SPDX-License-Identifier: Apache-2.0
"""Classes of ROS 2 messages, made from their definitions. They accept the same values as rosidl's classes: known fields only,
of the right type and within the range of the field."""

import copy
import sys
from array import array
from types import ModuleType

import numpy

# Types and fields, and constants, of the interfaces of ROS 2 (Humble to Jazzy) and of marine_acoustic_msgs.
DEFINITIONS = {
    "builtin_interfaces/Time": "int32 sec; uint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp; string frame_id",
    "geometry_msgs/Vector3": "float64 x; float64 y; float64 z",
    "geometry_msgs/Point": "float64 x; float64 y; float64 z",
    "geometry_msgs/Quaternion": "float64 x; float64 y; float64 z; float64 w = 1.0",
    "geometry_msgs/Pose": "geometry_msgs/Point position; geometry_msgs/Quaternion orientation",
    "geometry_msgs/PoseStamped": "std_msgs/Header header; geometry_msgs/Pose pose",
    "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose; float64[] covariance",
    "geometry_msgs/Twist": "geometry_msgs/Vector3 linear; geometry_msgs/Vector3 angular",
    "geometry_msgs/TwistWithCovariance": "geometry_msgs/Twist twist; float64[] covariance",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation; geometry_msgs/Quaternion rotation",
    "geometry_msgs/TransformStamped": "std_msgs/Header header; string child_frame_id; geometry_msgs/Transform transform",
    "nav_msgs/Odometry": "std_msgs/Header header; string child_frame_id; geometry_msgs/PoseWithCovariance pose;"
                         "geometry_msgs/TwistWithCovariance twist",
    "sensor_msgs/Image": "std_msgs/Header header; uint32 height; uint32 width; string encoding; uint8 is_bigendian; uint32 step;"
                         "uint8[] data",
    "sensor_msgs/LaserScan": "std_msgs/Header header; float32 angle_min; float32 angle_max; float32 angle_increment;"
                             "float32 time_increment; float32 scan_time; float32 range_min; float32 range_max;"
                             "float32[] ranges; float32[] intensities",
    "sensor_msgs/PointField": "INT8 = 1; UINT8 = 2; INT16 = 3; UINT16 = 4; INT32 = 5; UINT32 = 6; FLOAT32 = 7; FLOAT64 = 8;"
                              "string name; uint32 offset; uint8 datatype; uint32 count",
    "sensor_msgs/PointCloud2": "std_msgs/Header header; uint32 height; uint32 width; sensor_msgs/PointField[] fields;"
                               "bool is_bigendian; uint32 point_step; uint32 row_step; uint8[] data; bool is_dense",
    "sensor_msgs/Range": "std_msgs/Header header; uint8 radiation_type; float32 field_of_view; float32 min_range;"
                         "float32 max_range; float32 range; float32 variance",
    "sensor_msgs/RegionOfInterest": "uint32 x_offset; uint32 y_offset; uint32 height; uint32 width; bool do_rectify",
    "sensor_msgs/CameraInfo": "std_msgs/Header header; uint32 height; uint32 width; string distortion_model; float64[] d;"
                              "float64[9] k; float64[9] r; float64[12] p; uint32 binning_x; uint32 binning_y;"
                              "sensor_msgs/RegionOfInterest roi",
    "marine_acoustic_msgs/PingInfo": "float32 frequency; float32 sound_speed; float32[] tx_beamwidths; float32[] rx_beamwidths",
    "marine_acoustic_msgs/SonarImageData": "DTYPE_UINT8 = 0; DTYPE_UINT16 = 2; bool is_bigendian; uint32 dtype;"
                                           "uint32 beam_count; uint8[] data",
    "marine_acoustic_msgs/ProjectedSonarImage": "std_msgs/Header header; marine_acoustic_msgs/PingInfo ping_info;"
                                                "geometry_msgs/Vector3[] beam_directions; float32[] ranges;"
                                                "marine_acoustic_msgs/SonarImageData image",
    "rcl_interfaces/FloatingPointRange": "float64 from_value; float64 to_value; float64 step",
    "rcl_interfaces/IntegerRange": "int64 from_value; int64 to_value; uint64 step",
    "rcl_interfaces/ParameterDescriptor": "string name; uint8 type; string description; string additional_constraints;"
                                          "bool read_only; bool dynamic_typing;"
                                          "rcl_interfaces/FloatingPointRange[] floating_point_range;"
                                          "rcl_interfaces/IntegerRange[] integer_range",
}

CLASSES = {}
_INTEGERS = {"int32": (-2**31, 2**31 - 1), "uint8": (0, 255), "uint32": (0, 2**32 - 1), "int64": (-2**63, 2**63 - 1),
             "uint64": (0, 2**64 - 1)}
_ARRAYS = {"uint8": "B", "float32": "f", "float64": "d"}
_PLAIN = {"string": "", "bool": False, "float32": 0.0, "float64": 0.0, **dict.fromkeys(_INTEGERS, 0)}


def _check(kind, value, name):
    if kind in CLASSES:
        good = isinstance(value, CLASSES[kind])
    elif kind in _INTEGERS:
        low, high = _INTEGERS[kind]
        good = isinstance(value, int) and not isinstance(value, bool) and low <= value <= high
    else:
        good = isinstance(value, {"string": str, "bool": bool, "float32": float, "float64": float}[kind])
    if not good:
        raise AssertionError(f"{name} is of type {kind}, and {value!r} is none")


def _initial(kind):
    if kind.endswith("]") and not kind.endswith("[]"):
        return numpy.zeros(int(kind[kind.index("[") + 1:-1]))  # of float64
    if kind.endswith("[]"):
        code = _ARRAYS.get(kind[:-2])
        return array(code) if code else []
    return CLASSES[kind]() if kind in CLASSES else _PLAIN[kind]


def _field(kind, name):
    slot = "_" + name

    def assign(self, value):
        if kind.endswith("]") and not kind.endswith("[]"):
            raise AssertionError(f"{name} is of type {kind}, which no test needs")
        if kind.endswith("[]"):
            code = _ARRAYS.get(kind[:-2])
            if isinstance(value, array):
                if value.typecode != code:
                    raise AssertionError(f"{name} is of type {kind}, and an array of '{value.typecode}' is none")
            else:
                for one in value:
                    _check(kind[:-2], one, name)
                value = array(code, value) if code else list(value)
        else:
            _check(kind, value, name)
        setattr(self, slot, value)

    return property(lambda self: getattr(self, slot), assign)


def _make_class(full_name, definition):
    name = full_name.split("/")[1]
    fields, defaults, constants = {}, {}, {}
    for part in definition.split(";"):
        declared, _, value = part.partition("=")
        words = declared.split()
        if len(words) == 1:
            constants[words[0]] = int(value)
        else:
            fields[words[1]] = words[0]
            if value:
                defaults[words[1]] = float(value)

    def construct(self, **values):
        for field, kind in fields.items():
            setattr(self, "_" + field, copy.copy(defaults.get(field, _initial(kind))))
        for field, value in values.items():
            if field not in fields:
                raise AssertionError(f"{full_name} has no field {field}")
            setattr(self, field, value)

    members = {field: _field(kind, field) for field, kind in fields.items()}
    return type(name, (), {"__slots__": tuple("_" + field for field in fields), "__init__": construct, **members, **constants})


def _install():
    for full_name, definition in DEFINITIONS.items():
        CLASSES[full_name] = _make_class(full_name, definition)
        package, name = full_name.split("/")
        module = sys.modules.setdefault(package + ".msg", ModuleType(package + ".msg"))
        setattr(module, name, CLASSES[full_name])
        sys.modules.setdefault(package, ModuleType(package)).msg = module


_install()
