// SPDX-License-Identifier: Apache-2.0
// The picture of one head: the newest ping or the sweep, the grid over it, and what the cursor points at.
import { colourTable, drawBar } from "./colour.js";
import { Grid } from "./grid.js";
import { make, setText } from "./dom.js";
import { heightOfFan, Lookup, makeProjection } from "./projection.js";
import { Fan, Sweep } from "./samples.js";
import { degrees, number } from "./text.js";

const MOST_PIXELS = 1.6e6;  // of a canvas; beyond, a phone's display is finer than it is fast
const MOST_ROWS = 1200;
const BACKGROUND = "#06090d";

export class Picture {
  /** `drawn` is called with each ping that has been drawn. */
  constructor(drawn) {
    this.drawn = drawn;
    this.mode = "fan";
    this.map = "Amber";
    this.gain_db = 0;
    this.cursor = null;  // of the page, from the corner of the stage
    this.image = make("canvas", { class: "echoes" });
    this.overlay = make("canvas", { class: "grid" });
    this.stage = make("div", { class: "stage" }, this.image, this.overlay);
    this.readout = make("output", { class: "readout", text: "Point at the picture." });
    this.bar = make("canvas", { class: "bar", width: 128, height: 8 });
    this.barEnd = make("span", { text: "255" });
    this.legend = make("div", { class: "legend" }, this.readout,
      make("div", { class: "scale", title: "Colours of sample values" }, make("span", { text: "0" }), this.bar, this.barEnd));
    this.listen();
  }

  listen() {
    new ResizeObserver(() => this.changeView()).observe(this.stage);
    const point = (event) => {
      const box = this.stage.getBoundingClientRect();
      this.cursor = [event.clientX - box.left, event.clientY - box.top];
      this.schedule("grid");
    };
    this.stage.addEventListener("pointermove", point);
    this.stage.addEventListener("pointerdown", point);
    this.stage.addEventListener("pointerleave", (event) => {
      if (event.pointerType === "mouse") {
        this.cursor = null;
        this.schedule("grid");
      }
    });
  }

  /** Rows that a frame needs to have one for each pixel. */
  get wantedRows() {
    return Math.max(100, Math.min(MOST_ROWS, Math.ceil(this.projection?.radius_px ?? 600)));
  }

  take(ping) {
    if (!this.model || Boolean(this.model.turns) !== ping.scanning) {
      this.model = ping.scanning ? new Sweep() : new Fan();
      this.stage.dataset.scanning = ping.scanning;
      this.shape = null;
    }
    this.model.take(ping);
    this.ping = ping;
    this.isNew = true;
    if (this.model.shape !== this.shape || this.bits !== ping.bits) {
      this.shape = this.model.shape;
      this.bits = ping.bits;
      this.changeView();
    }
    this.schedule("image");
    if (ping.scanning || this.cursor) {
      this.schedule("grid");
    }
  }

  set(property, value) {
    this[property] = value;
    this.stage.dataset.mode = this.mode;
    this.changeView();
  }

  /** The box of a fan is as high as the fan; that of a B-scan has the height of the style sheet. */
  fit() {
    const high = this.mode === "fan" && this.model?.samples ? `${Math.round(heightOfFan(this.model, this.stage.clientWidth))}px` : "";
    if (this.stage.style.height !== high) {
      this.stage.style.height = high;
    }
  }

  changeView() {
    this.viewChanged = true;
    this.schedule("image");
    this.schedule("grid");
  }

  schedule(what) {
    this[`${what}Changed`] = true;
    this.pending ??= requestAnimationFrame(() => {
      this.pending = null;
      this.draw();
    });
  }

  draw() {
    if (!this.model?.samples || !this.stage.clientWidth) {
      return;
    }
    if (this.viewChanged) {
      this.fit();
      this.prepare();
    }
    if (this.imageChanged) {
      this.drawImage();
    }
    if (this.gridChanged) {
      this.drawGrid();
    }
    this.viewChanged = this.imageChanged = this.gridChanged = false;
    this.read();
    if (this.isNew) {
      this.isNew = false;
      this.drawn(this.ping);
    }
  }

  prepare() {
    const { clientWidth, clientHeight } = this.stage;
    this.scale = Math.min(devicePixelRatio || 1, Math.sqrt(MOST_PIXELS / (clientWidth * clientHeight)));
    const width = Math.round(clientWidth * this.scale);
    const height = Math.round(clientHeight * this.scale);
    const lookupOf = [this.shape, this.mode, width, height].join();
    if (lookupOf !== this.lookupOf) {
      this.lookupOf = lookupOf;
      for (const canvas of [this.image, this.overlay]) {
        Object.assign(canvas, { width, height });
      }
      this.pixels = this.image.getContext("2d").createImageData(width, height);
      this.projection = makeProjection(this.mode, this.model, width, height, this.scale);
      this.lookup = new Lookup(this.model, this.projection, width, height);
    }
    this.maximum = this.bits === 4 ? 15 : 255;
    this.table = colourTable(this.map, { maximum: this.maximum, gain_db: this.gain_db, amplitudes: !this.model.turns });
    drawBar(this.bar, this.table, this.maximum);
    setText(this.barEnd, String(this.maximum));
  }

  drawImage() {
    this.lookup.paint(new Uint32Array(this.pixels.data.buffer), this.model.samples, this.table);
    this.image.getContext("2d").putImageData(this.pixels, 0, 0);
  }

  drawGrid() {
    const context = this.overlay.getContext("2d");
    context.clearRect(0, 0, this.overlay.width, this.overlay.height);
    const grid = new Grid(context, this.scale);
    grid.draw(this.mode, this.model, this.projection);
    if (this.model.turns && this.model.newest_rad !== null) {
      grid.newest(this.projection, this.model.newest_rad);
    }
    if (this.pointed()) {
      grid.cursor(this.cursor[0] * this.scale, this.cursor[1] * this.scale);
    }
  }

  /** What the cursor points at; null outside the picture. */
  pointed() {
    if (!this.cursor || !this.projection) {
      return null;
    }
    const place = this.projection.polar(this.cursor[0] * this.scale, this.cursor[1] * this.scale);
    const { first_rad, last_rad, bin_m } = this.model;
    const within = place.range_m >= 0 && place.range_m < this.projection.range_m && place.bearing_rad >= first_rad && place.bearing_rad <= last_rad;
    return within ? { ...place, value: this.model.valueAt(Math.floor(place.range_m / bin_m), place.bearing_rad) } : null;
  }

  read() {
    const place = this.pointed();
    if (!place) {
      for (const name of ["range", "bearing", "value"]) {
        delete this.readout.dataset[name];
      }
      setText(this.readout, "Point at the picture.");
      return;
    }
    this.readout.dataset.range = place.range_m.toFixed(4);
    this.readout.dataset.bearing = ((place.bearing_rad * 180) / Math.PI).toFixed(3);
    this.readout.dataset.value = place.value ?? "";
    const decimals = this.model.bin_m < 0.01 ? 3 : 2;
    setText(this.readout, `${number(place.range_m, decimals, "m")}   ${degrees(place.bearing_rad)}   value ${place.value ?? "–"}`);
  }

  /** Picture, grid, colour bar and caption as a PNG: a promise of a Blob. */
  png(caption) {
    const strip = Math.round(30 * this.scale);
    const canvas = make("canvas", { width: this.image.width, height: this.image.height + strip });
    const context = canvas.getContext("2d");
    context.fillStyle = BACKGROUND;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(this.image, 0, 0);
    context.drawImage(this.overlay, 0, 0);
    const grid = new Grid(context, this.scale);
    const middle = this.image.height + strip / 2;
    const width = 128 * this.scale;
    const right = canvas.width - 42 * this.scale;
    grid.label(caption, 12 * this.scale, middle, "left");
    context.drawImage(this.bar, right - width, middle - 4 * this.scale, width, 8 * this.scale);
    grid.label("0", right - width - 6 * this.scale, middle, "right");
    grid.label(String(this.maximum), right + 6 * this.scale, middle, "left");
    return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
  }
}
