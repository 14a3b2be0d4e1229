// SPDX-License-Identifier: Apache-2.0
// A publisher of poses with an adjustable clock; posecast's clock is always right.
import dgram from "node:dgram";
import protobuf from "protobufjs";

export class PosePublisher {
  /** Sends the pose 20 times a second to a port of 127.0.0.1, stamped by a clock of `ticks_per_s`. */
  constructor(schema, port, position_m, ticks_per_s = 1e9) {
    this.back_s = 0; // offset by which the clock is set back
    const update = protobuf.loadSync(schema).lookupType("sonard.pose.PoseUpdate");
    const [x, y, z] = position_m;
    this.socket = dgram.createSocket("udp4");
    this.timer = setInterval(() => {
      const time_ns = Math.round((performance.now() / 1000 - this.back_s) * ticks_per_s);
      // protobufjs has the field names of pose.proto in camel case.
      const vehicle = { positionM: { x, y, z }, orientation: { w: 1 } };
      this.socket.send(update.encode(update.create({ timeNs: time_ns, vehicle })).finish(), port, "127.0.0.1");
    }, 50);
  }

  close() {
    clearInterval(this.timer);
    this.socket.close();
  }
}
