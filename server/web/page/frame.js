// SPDX-License-Identifier: Apache-2.0
// One binary message of the daemon: header, bearings, samples.

/**
 * Reads a ping. Returns the header with `bearings` (Float32Array, radians, positive to starboard) and `samples`
 * (Uint8Array). A fan has row after row from near to far, each from port to starboard; a scanning head has line after
 * line, each from near to far. Throws where the sizes do not fit.
 */
export function readPing(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const start = 4 + length;
  if (length % 4 !== 0 || start > buffer.byteLength) {
    throw new Error("A ping has an incomplete header.");
  }
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const directions = header.scanning ? header.lines : header.beams;
  if (start + directions * (4 + header.rows) !== buffer.byteLength) {
    throw new Error("A ping does not have the number of samples in its header.");
  }
  return {
    ...header,
    bearings: new Float32Array(buffer, start, directions).map((toPort) => -toPort),
    samples: new Uint8Array(buffer, start + 4 * directions, directions * header.rows),
  };
}
