// SPDX-License-Identifier: Apache-2.0
// What there is to draw of a head: a grid of samples, row after row from near to far, with a column for each direction.

const CELLS = 1440;  // of a turn of a scanning head: a quarter of a degree each
const CELL_RAD = (2 * Math.PI) / CELLS;
const WIDEST_LINE_RAD = Math.PI / 12;  // neighbours farther apart do not belong to one sweep

/** The samples of a multibeam's last ping, by its own table of bearings. */
export class Fan {
  constructor() {
    this.samples = null;
    this.shape = "";
  }

  take(ping) {
    this.samples = ping.samples;
    this.columns = ping.beams;
    this.rows = ping.rows;
    this.bin_m = ping.bin_m;
    this.bearings = ping.bearings;
    const last = ping.beams - 1;
    const shape = [ping.beams, ping.rows, ping.bin_m, ...[0, 1, last >> 1, last].map((beam) => ping.bearings[beam])].join();
    if (shape !== this.shape) {
      this.shape = shape;
      this.first_rad = this.bearings[0] - this.halfBeam(0, 1);
      this.last_rad = this.bearings[last] + this.halfBeam(last - 1, last);
    }
  }

  halfBeam(beam, next) {
    return beam < 0 || next >= this.columns ? 0.01 : (this.bearings[next] - this.bearings[beam]) / 2;
  }

  /** Fractional column of a bearing, whole at the centre of a beam; NaN outside the fan. */
  column(bearing_rad) {
    if (!(bearing_rad >= this.first_rad && bearing_rad <= this.last_rad)) {
      return NaN;
    }
    let low = 0;
    let high = this.columns - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.bearings[middle] <= bearing_rad) {
        low = middle;
      } else {
        high = middle;
      }
    }
    const step = this.bearings[high] - this.bearings[low];
    return step > 0 ? low + (bearing_rad - this.bearings[low]) / step : low;
  }

  /** The sample at a place, null where there is none. */
  valueAt(row, bearing_rad) {
    const column = this.column(bearing_rad);
    if (!this.samples || Number.isNaN(column) || row < 0 || row >= this.rows) {
      return null;
    }
    return this.samples[row * this.columns + Math.min(this.columns - 1, Math.max(0, Math.round(column)))];
  }
}

/** The lines of a scanning head as it turns: each stays until the head looks there again. */
export class Sweep {
  constructor() {
    this.samples = null;
    this.shape = "";
    this.columns = CELLS;
    this.turns = true;  // the first column is beside the last
    this.first_rad = -Math.PI;
    this.last_rad = Math.PI;
    this.newest_rad = null;
  }

  take(ping) {
    const shape = [ping.rows, ping.bin_m].join();
    if (shape !== this.shape) {
      this.shape = shape;
      this.rows = ping.rows;
      this.bin_m = ping.bin_m;
      this.samples = new Uint8Array(CELLS * ping.rows);
      this.covered = new Uint8Array(CELLS);
      this.newest_rad = null;
    }
    for (let line = 0; line < ping.bearings.length; ++line) {
      this.takeLine(ping.bearings[line], ping.samples.subarray(line * ping.rows, (line + 1) * ping.rows));
    }
  }

  takeLine(bearing_rad, line) {
    let step = this.newest_rad === null ? CELL_RAD : Math.abs(bearing_rad - this.newest_rad);
    step = Math.min(step, 2 * Math.PI - step);
    if (step > 0 && step <= WIDEST_LINE_RAD) {
      this.step_rad = step;
    }
    const half = (this.step_rad ?? CELL_RAD) / 2;
    const from = Math.ceil(this.column(bearing_rad - half));
    const to = Math.max(from, Math.ceil(this.column(bearing_rad - half) + (2 * half) / CELL_RAD) - 1);
    for (let cell = from; cell <= to; ++cell) {
      this.fillCell((cell + CELLS) % CELLS, line);
    }
    this.newest_rad = bearing_rad;
  }

  fillCell(cell, line) {
    this.covered[cell] = 1;
    for (let row = 0, place = cell; row < this.rows; ++row, place += CELLS) {
      this.samples[place] = line[row];
    }
  }

  /** Fractional column of a bearing; every bearing has one. */
  column(bearing_rad) {
    const turn = bearing_rad - 2 * Math.PI * Math.floor((bearing_rad + Math.PI) / (2 * Math.PI));
    return (turn + Math.PI) / CELL_RAD - 0.5;
  }

  valueAt(row, bearing_rad) {
    if (!this.samples || row < 0 || row >= this.rows) {
      return null;
    }
    const cell = (Math.round(this.column(bearing_rad)) + CELLS) % CELLS;
    return this.covered[cell] ? this.samples[row * CELLS + cell] : null;
  }
}
