// SPDX-License-Identifier: Apache-2.0
// Colour maps. Brightness rises with the value in each, so that a picture reads the same in grey.

// Stops at equal distances, red, green and blue.
const MAPS = {
  Amber: [[4, 6, 10], [48, 24, 13], [112, 54, 19], [181, 100, 29], [228, 150, 60], [250, 205, 128], [255, 246, 226]],
  Grey: [[4, 5, 6], [52, 54, 56], [103, 105, 107], [153, 155, 157], [204, 205, 206], [250, 250, 250]],
  Ice: [[3, 6, 12], [10, 38, 70], [16, 79, 122], [30, 128, 164], [90, 182, 198], [172, 222, 224], [244, 252, 250]],
  Viridis: [[8, 4, 18], [64, 38, 116], [56, 88, 140], [37, 133, 142], [56, 180, 118], [150, 214, 64], [253, 231, 60]],
  Night: [[6, 2, 2], [44, 6, 5], [88, 10, 8], [136, 16, 12], [184, 30, 20], [228, 62, 42]],
};

export const mapNames = Object.keys(MAPS);

function colourAt(stops, share) {
  const place = share * (stops.length - 1);
  const lower = Math.min(stops.length - 2, Math.floor(place));
  return stops[lower].map((from, channel) => from + (stops[lower + 1][channel] - from) * (place - lower));
}

/**
 * The colour of each of 256 sample values, as 32 bits in the order of ImageData. `maximum`: the largest sample (15 of
 * four bits). `amplitudes`: shown by their square root, as displays stretch them; decibels are shown as they are.
 */
export function colourTable(name, { maximum, gain_db, amplitudes }) {
  const table = new Uint32Array(256);
  const factor = 10 ** (gain_db / 20) / maximum;
  for (let value = 0; value < 256; ++value) {
    const share = Math.min(1, value * factor);
    const [red, green, blue] = colourAt(MAPS[name], amplitudes ? Math.sqrt(share) : share);
    table[value] = (0xff000000 | (blue << 16) | (green << 8) | red) >>> 0;
  }
  return table;
}

/** Draws the bar of a table: sample values from 0 to `maximum`, left to right. */
export function drawBar(canvas, table, maximum) {
  const context = canvas.getContext("2d");
  const image = context.createImageData(canvas.width, 1);
  const pixels = new Uint32Array(image.data.buffer);
  for (let x = 0; x < canvas.width; ++x) {
    pixels[x] = table[Math.round((x / (canvas.width - 1)) * maximum)];
  }
  for (let y = 0; y < canvas.height; ++y) {
    context.putImageData(image, 0, y);
  }
}
