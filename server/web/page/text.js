// SPDX-License-Identifier: Apache-2.0
// Numbers as people read them. What is not known is a dash.

const UNKNOWN = "–";

function known(value) {
  return typeof value === "number" && Number.isFinite(value);
}

/** A number with so many decimals, a true minus sign, and its unit. */
export function number(value, decimals = 0, unit = "") {
  if (!known(value)) {
    return UNKNOWN;
  }
  const text = value.toFixed(decimals);
  const zero = Number(text) === 0;
  const digits = (zero ? text.replace("-", "") : text).replace("-", "−");
  return unit ? `${digits} ${unit}` : digits;
}

export function milliseconds(value) {
  if (known(value) && value >= 1000) {
    return duration(value / 1000);
  }
  return number(value, known(value) && Math.abs(value) < 10 ? 1 : 0, "ms");
}

/** A time span in seconds, in the unit that suits it. */
export function duration(seconds) {
  if (!known(seconds)) {
    return UNKNOWN;
  }
  if (seconds < 1) {
    return number(1000 * seconds, 0, "ms");
  }
  if (seconds < 100) {
    return number(seconds, seconds < 10 ? 1 : 0, "s");
  }
  const minutes = Math.floor(seconds / 60);
  return minutes < 100 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

export function bytes(value) {
  if (!known(value)) {
    return UNKNOWN;
  }
  const units = ["B", "kB", "MB", "GB", "TB"];
  let unit = 0;
  while (value >= 1000 && unit + 1 < units.length) {
    value /= 1000;
    ++unit;
  }
  return number(value, unit && value < 100 ? 1 : 0, units[unit]);
}

/** A count with groups of three digits. */
export function count(value) {
  return known(value) ? String(value).replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f") : UNKNOWN;
}

export function degrees(radians, decimals = 1) {
  return known(radians) ? `${number((radians * 180) / Math.PI, decimals)}°` : UNKNOWN;
}

export function position(point) {
  return Array.isArray(point) ? point.map((value) => number(value, 2)).join(", ") + " m" : UNKNOWN;
}
