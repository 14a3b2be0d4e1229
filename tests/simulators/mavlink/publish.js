// SPDX-License-Identifier: Apache-2.0
// A vehicle at rest in node-mavlink's messages: 50 times a second until it is ended.
//   node publish.js PORT VERSION KIND NORTH EAST DOWN ROLL PITCH YAW
// KIND: odometry, angles (LOCAL_POSITION_NED and ATTITUDE) or quaternion (... and ATTITUDE_QUATERNION). Metres and degrees
// in MAVLink's own axes; attitudes come 10 ms after positions, and heartbeats between.
'use strict';
const dgram = require('dgram');
const { MavLinkProtocolV1, MavLinkProtocolV2, minimal, common } = require('node-mavlink');

const [port, version, kind, ...numbers] = process.argv.slice(2);
const [north, east, down, roll, pitch, yaw] = numbers.map(Number);
const radians = (degrees) => (degrees * Math.PI) / 180;
const protocol = version === '1' ? new MavLinkProtocolV1(1, 1) : new MavLinkProtocolV2(1, 1);
const socket = dgram.createSocket('udp4');
const begin = Date.now();
let sequence = 0;

function send(message) {
  socket.send(protocol.serialize(message, sequence++ & 0xff), Number(port), '127.0.0.1');
}

// Yaw, then pitch, then roll: the product of three half-angle quaternions, written out.
function quaternion() {
  const [cr, cp, cy] = [roll, pitch, yaw].map((angle) => Math.cos(radians(angle) / 2));
  const [sr, sp, sy] = [roll, pitch, yaw].map((angle) => Math.sin(radians(angle) / 2));
  return [
    cr * cp * cy + sr * sp * sy,
    sr * cp * cy - cr * sp * sy,
    cr * sp * cy + sr * cp * sy,
    cr * cp * sy - sr * sp * cy,
  ];
}


function position() {
  send(Object.assign(new common.LocalPositionNed(), {
    timeBootMs: Date.now() - begin, x: north, y: east, z: down, vx: 0, vy: 0, vz: 0 }));
}

function attitude() {
  const rates = { timeBootMs: Date.now() - begin, rollspeed: 0, pitchspeed: 0, yawspeed: 0 };
  if (kind === 'angles') {
    send(Object.assign(new common.Attitude(), { ...rates, roll: radians(roll), pitch: radians(pitch), yaw: radians(yaw) }));
    return;
  }
  const [q1, q2, q3, q4] = quaternion();
  send(Object.assign(new common.AttitudeQuaternion(), { ...rates, q1, q2, q3, q4, reprOffsetQ: [0, 0, 0, 0] }));
}

function odometry() {
  send(Object.assign(new common.Odometry(), {
    timeUsec: BigInt(Date.now()) * 1000n, frameId: common.MavFrame.LOCAL_NED, childFrameId: common.MavFrame.BODY_FRD,
    x: north, y: east, z: down, q: quaternion(), vx: 0, vy: 0, vz: 0, rollspeed: 0, pitchspeed: 0, yawspeed: 0,
    poseCovariance: new Array(21).fill(0), velocityCovariance: new Array(21).fill(0),
    resetCounter: 0, estimatorType: 0, quality: 0 }));
}

function heartbeat() {
  send(Object.assign(new minimal.Heartbeat(), {
    type: minimal.MavType.SUBMARINE, autopilot: minimal.MavAutopilot.ARDUPILOTMEGA, baseMode: 0, customMode: 0,
    systemStatus: minimal.MavState.ACTIVE, mavlinkVersion: 3 }));
}

setInterval(heartbeat, 1000);
setInterval(() => {
  if (kind === 'odometry') {
    odometry();
    return;
  }
  position();
  setTimeout(attitude, 10);
}, 20);
