# SPDX-License-Identifier: Apache-2.0
"""Converts ROS messages for roscast: odometry and transforms become messages of protocol/pose/pose.proto.

This module needs no roscore and no socket.
"""
import collections
import math

import genpy
import tf2_py

import pose_pb2

FRAMES = {"enu_flu": pose_pb2.FRAME_ENU_FLU, "ned_frd": pose_pb2.FRAME_NED_FRD}

# More than the delay of late messages in a network; sonard's own pose sources use the same limit.
SET_BACK_NS = 250_000_000
# sonard rejects values beyond these limits (protocol/pose/transform.hpp, pose_codec.hpp). roscast reports them itself.
MAX_COORDINATE_M = 1e8
MAX_SPEED = 1e6
MIN_QUATERNION_NORM, MAX_QUATERNION_NORM = 1e-3, 1e3


def without_slash(frame):
    """Frame names of tf1 may begin with a slash, which has no meaning."""
    return frame[1:] if frame.startswith("/") else frame


def numbers(message, names="xyz"):
    return [getattr(message, name) for name in names]


def copy_numbers(ours, theirs, names="xyz"):
    for name in names:
        setattr(ours, name, getattr(theirs, name))


def normalize(position, orientation):
    """Scales the quaternion to norm 1. Returns the fault of the pose, or None."""
    if not all(map(math.isfinite, numbers(position))):
        return "position is not finite"
    if max(map(abs, numbers(position))) > MAX_COORDINATE_M:
        return "position is beyond 1e8 m"
    if not all(map(math.isfinite, numbers(orientation, "wxyz"))):
        return "orientation is not finite"
    norm = math.hypot(*numbers(orientation, "wxyz"))
    if not MIN_QUATERNION_NORM <= norm <= MAX_QUATERNION_NORM:
        return "orientation has a norm outside 0.001..1000, so it is not a rotation"
    for name in "wxyz":
        setattr(orientation, name, getattr(orientation, name) / norm)
    return None


def fault_of_twist(twist):
    for vector in (twist.linear, twist.angular):
        # NaN fails every comparison.
        if not math.hypot(*numbers(vector)) <= MAX_SPEED:
            return "twist is not finite, or beyond 1e6"
    return None


class FrameTree:
    """The frames of /tf and /tf_static in a tf2 buffer, which interpolates and keeps 10 s."""

    def __init__(self):
        self._buffer = tf2_py.BufferCore()
        self._newest_ns = {}  # by child frame

    def insert(self, transform, is_static):
        """Returns True if its stamp was far behind the newest one of the same frame. Then the clock was set back (a
        simulation was reset), and all earlier transforms except /tf_static are dropped."""
        if is_static:
            self._buffer.set_transform_static(transform, "")
            return False
        stamp_ns = transform.header.stamp.to_nsec()
        newest_ns = self._newest_ns.get(transform.child_frame_id)
        if stamp_ns == newest_ns:
            return False  # from a paused simulation; tf2 would reject it and print a line each time
        reset = newest_ns is not None and stamp_ns < newest_ns - SET_BACK_NS
        if reset:
            self._buffer.clear()
            self._newest_ns.clear()
            newest_ns = None
        self._newest_ns[transform.child_frame_id] = stamp_ns if newest_ns is None else max(newest_ns, stamp_ns)
        self._buffer.set_transform(transform, "")
        return reset

    def newest(self, root, frame):
        """The pose of `frame` in `root` at the newest time for which the whole chain is known. A stamp of 0 means that the
        chain never changes. Raises tf2_py.TransformException."""
        return self._buffer.lookup_transform_core(root, frame, genpy.Time())

    def at(self, stamp, root, frame):
        """The pose of `frame` in `root` at `stamp`, or at the newest time if that is not known; None if there is no pose."""
        for time in (stamp, genpy.Time()):
            try:
                return self._buffer.lookup_transform_core(root, frame, time)
            except tf2_py.TransformException:
                pass
        return None

    def frames(self):
        return sorted(self._buffer._getFrameStrings())


class PoseBridge:
    """Calls send(PoseUpdate) for each pose of the vehicle, and say(line) with messages for a person. Uses one thread."""

    def __init__(self, send, say, odometry, world_frame="world", vehicle_frame="", axes="enu_flu", bodies=()):
        """`odometry`: whether the vehicle's pose comes from odometry, else from tf. `vehicle_frame`: with odometry the
        expected child_frame_id, empty for any; else the vehicle's frame in tf. `bodies`: pairs of a tf frame and the body
        in sonard's world that follows it."""
        self._send_update, self._say = send, say
        self._by_odometry = odometry
        self._world_frame = without_slash(world_frame)
        self._vehicle_frame = without_slash(vehicle_frame)
        self._axes = axes
        self._bodies = [(without_slash(frame), body) for frame, body in bodies]
        self._tree = FrameTree()
        self._newest_ns = 0  # newest stamp of the vehicle sent from tf
        self._said = set()
        # poses: sent; wrong_frame: odometry with an unexpected frame; no_stamp: stamp of 0; bad_value: not finite, no
        # rotation, or beyond the limits; clock_resets.
        self.counters = collections.Counter()

    def _drop(self, counter, line):
        """Counts each dropped message, and prints each line only once."""
        self.counters[counter] += 1
        if line not in self._said:
            self._said.add(line)
            self._say(line)

    def on_odometry(self, message):
        frame = without_slash(message.header.frame_id)
        child = without_slash(message.child_frame_id)
        if frame != self._world_frame:
            self._drop("wrong_frame", f"odometry with frame_id '{frame}' is dropped: expected '{self._world_frame}'. "
                       f"If '{frame}' is the frame of sonard's world, use --world-frame {frame}, and --axes ned_frd if "
                       "its z points down")
        elif self._vehicle_frame and child != self._vehicle_frame:
            self._drop("wrong_frame", f"odometry with child_frame_id '{child}' is dropped: expected "
                       f"'{self._vehicle_frame}' (--vehicle-frame)")
        elif message.header.stamp.is_zero():
            self._drop("no_stamp", "odometry with a header.stamp of 0 is dropped: its publisher must fill in the time")
        else:
            pose, twist = message.pose.pose, message.twist.twist
            fault = normalize(pose.position, pose.orientation) or fault_of_twist(twist)
            if fault:
                self._drop("bad_value", f"odometry is dropped: {fault}")
            else:
                self._send(message.header, child, pose.position, pose.orientation, twist)

    def on_transforms(self, transforms, is_static):
        """Handles all transforms of one message of /tf (False) or /tf_static (True)."""
        for transform in transforms:
            child = transform.child_frame_id = without_slash(transform.child_frame_id)
            transform.header.frame_id = without_slash(transform.header.frame_id)
            fault = normalize(transform.transform.translation, transform.transform.rotation)
            if fault:
                self._drop("bad_value", f"the transform to '{child}' is dropped: {fault}")
            elif self._tree.insert(transform, is_static):
                self.counters["clock_resets"] += 1
                self._newest_ns = 0
                self._say(f"the stamps of frame '{child}' went back to {transform.header.stamp.to_sec():.3f} s: "
                          "earlier transforms are dropped. If this repeats, two publishers send the same frame")
        if not self._by_odometry and not is_static:
            self._send_from_tree({transform.child_frame_id for transform in transforms})

    def _send_from_tree(self, changed_frames):
        try:
            vehicle = self._tree.newest(self._world_frame, self._vehicle_frame)
        except tf2_py.TransformException:
            return  # the rest may come in another message; why_no_vehicle() reports a chain that stays broken
        stamp_ns = vehicle.header.stamp.to_nsec()
        if stamp_ns == 0:
            self._drop("no_stamp", f"the transform from '{self._world_frame}' to '{self._vehicle_frame}' never changes: "
                       "set it as poses.initial")
            return
        # Other frames do not change the vehicle's pose. A paused simulation sends the same time again.
        again = stamp_ns == self._newest_ns and self._vehicle_frame in changed_frames
        if stamp_ns > self._newest_ns or again:
            self._newest_ns = stamp_ns
            self._send(vehicle.header, self._vehicle_frame, vehicle.transform.translation, vehicle.transform.rotation)

    def _send(self, header, child, position, orientation, twist=None):
        """Sends the numbers unchanged: sonard supports both axes, and the twist of Odometry is in the vehicle's axes."""
        update = pose_pb2.PoseUpdate(time_ns=header.stamp.to_nsec(), frame=FRAMES[self._axes])
        copy_numbers(update.vehicle.position_m, position)
        copy_numbers(update.vehicle.orientation, orientation, "wxyz")
        if twist is not None:
            copy_numbers(update.twist.linear_mps, twist.linear)
            copy_numbers(update.twist.angular_radps, twist.angular)
        for frame, body in self._bodies:
            found = self._tree.at(header.stamp, self._world_frame, frame)
            if found:
                pose = update.bodies.add(name=body).pose
                copy_numbers(pose.position_m, found.transform.translation)
                copy_numbers(pose.orientation, found.transform.rotation, "wxyz")
        self.counters["poses"] += 1
        if self.counters["poses"] == 1:
            x, y, z = numbers(position)
            east, north, up = (x, y, z) if self._axes == "enu_flu" else (y, x, -z)
            self._say(f"first pose: '{child}' in '{without_slash(header.frame_id)}' at {header.stamp.to_sec():.3f} s, "
                      f"({east:.2f}, {north:.2f}, {up:.2f}) east, north, up")
        self._send_update(update)

    def why_no_vehicle(self):
        """Why tf has no pose of the vehicle: tf2's reason and the known frames, in one line."""
        problem = ""
        try:
            self._tree.newest(self._world_frame, self._vehicle_frame)
        except tf2_py.TransformException as error:
            problem = str(error)
        return f"{problem}; known frames: {', '.join(self._tree.frames())}"
