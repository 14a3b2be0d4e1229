// SPDX-License-Identifier: Apache-2.0
// Debian's Chromium with sonard's page, and queries of tests. Every wait has a deadline.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { chromium } from "playwright-core";

const PATIENCE_MS = 20000;
const DESK = { width: 1400, height: 900 };
export const PHONE = { width: 390, height: 844 };

export function startBrowser() {
  // Tests may run as root, and Chromium then has no sandbox; it opens only the page.
  return chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--disable-dev-shm-usage"] });
}

/** Opens the page at an address. `page.complaints` collects errors of its scripts and breaches of its policy. */
export async function open(browser, address, viewport = DESK, hash = "") {
  const page = await browser.newPage({ viewport, acceptDownloads: true });
  page.setDefaultTimeout(PATIENCE_MS);
  page.complaints = [];
  page.on("pageerror", (error) => page.complaints.push(error.message));
  page.on("console", (message) => {
    // The browser itself logs failed connections, which tests cause on purpose.
    if (message.type() === "error" && !/ERR_CONNECTION|WebSocket connection|status of 403/.test(message.text())) {
      page.complaints.push(message.text());
    }
  });
  await page.goto(`http://${address}/${hash}`);
  return page;
}

export function head(page, index) {
  return page.locator(`[data-head="${index}"]`);
}

export async function framesOf(page, index) {
  return Number(await head(page, index).getAttribute("data-frames"));
}

/** Asks again and again until `holds` does. */
export async function until(what, holds, patience_ms = PATIENCE_MS) {
  const end = Date.now() + patience_ms;
  for (;;) {
    const got = await holds();
    if (got) {
      return got;
    }
    assert.ok(Date.now() < end, `waited ${patience_ms / 1000} s for: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

export async function framesAdvance(page, index, by = 5) {
  const before = await framesOf(page, index);
  await until(`${by} more frames of head ${index}`, async () => (await framesOf(page, index)) >= before + by, 60000);
}

/**
 * Where the first strong echo is in the picture of a head, in pixels of the page: of all pixels with at least half of
 * the greatest brightness, the one nearest to the sonar. Read from the pixels alone.
 */
async function firstStrongEcho(page, index) {
  return head(page, index).locator("canvas.echoes").evaluate((canvas) => {
    const { width, height } = canvas;
    const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
    const drawn = { left: width, right: 0, bottom: 0, top: height, most: 0 };
    for (let y = 0, i = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x, i += 4) {
        if (data[i + 3]) {
          drawn.left = Math.min(drawn.left, x);
          drawn.right = Math.max(drawn.right, x);
          drawn.top = Math.min(drawn.top, y);
          drawn.bottom = Math.max(drawn.bottom, y);
          drawn.most = Math.max(drawn.most, data[i] + data[i + 1] + data[i + 2]);
        }
      }
    }
    const turns = canvas.parentElement.dataset.scanning === "true";
    const polar = canvas.parentElement.dataset.mode === "polar";
    const apex = { x: (drawn.left + drawn.right) / 2, y: turns ? (drawn.top + drawn.bottom) / 2 : drawn.bottom };
    let first = null;
    for (let y = 0, i = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x, i += 4) {
        const away = polar ? height - y : Math.hypot(x - apex.x, y - apex.y);
        if (data[i] + data[i + 1] + data[i + 2] >= drawn.most / 2 && (!first || away < first.away)) {
          first = { x, y, away };
        }
      }
    }
    const bin_m = Number(canvas.closest("[data-bin]").dataset.bin);
    const pixels = (drawn.bottom - drawn.top) * (turns && !polar ? 0.5 : 1);  // of the full range
    const box = canvas.getBoundingClientRect();
    const scale = box.width / width;
    // By the geometry of the two pictures: ahead is up and port on the left; or bearing to the right, range upwards.
    const drawnAt = polar
      ? { share: (drawn.bottom + 1 - first.y) / pixels, bearing_deg: ((first.x - drawn.left) / (drawn.right - drawn.left) - 0.5) * (turns ? 360 : 120) }
      : { share: Math.hypot(first.x - apex.x, first.y - apex.y) / pixels, bearing_deg: (Math.atan2(first.x - apex.x, apex.y - first.y) * 180) / Math.PI };
    return { bin_m, pixels, drawnAt, x: box.left + (first.x + 0.5) * scale, y: box.top + (first.y + 0.5) * scale };
  });
}

/**
 * Points at the first strong echo of a head, a fan of 120 degrees or a turn: it is drawn where the target is, and what
 * the page reads there is the target, within a bin and the pixel pointed at.
 */
export async function readsTarget(page, index, { range_m, bearing_deg }, full_range_m) {
  await head(page, index).locator(".stage").scrollIntoViewIfNeeded();
  const echo = await firstStrongEcho(page, index);
  await page.mouse.move(echo.x, echo.y);
  const readout = head(page, index).locator(".readout[data-range]");
  await readout.waitFor();
  const [range, bearing, value] = await Promise.all(["range", "bearing", "value"].map(async (name) => Number(await readout.getAttribute(`data-${name}`))));
  const { bin_m, drawnAt } = echo;
  const pixel_m = full_range_m / echo.pixels;
  const drawn_m = drawnAt.share * full_range_m;
  assert.ok(Math.abs(drawn_m - range_m) <= bin_m + 2 * pixel_m, `drawn at ${drawn_m} m, the target is at ${range_m} m`);
  assert.ok(Math.abs(drawnAt.bearing_deg - bearing_deg) <= 3, `drawn at ${drawnAt.bearing_deg} degrees, the target is at ${bearing_deg}`);
  assert.ok(Math.abs(range - range_m) <= bin_m + pixel_m, `range ${range} m, the target is at ${range_m} m, a bin has ${bin_m} m`);
  assert.ok(Math.abs(bearing - bearing_deg) <= 3, `bearing ${bearing}, the target is at ${bearing_deg}`);
  assert.ok(value > 0, "the echo has a value");
  assert.match(await readout.textContent(), new RegExp(`${range.toFixed(2)} m`));
}

/** Saves the picture of a head: the bytes, which are a PNG at least as large as asked for. */
export async function savesPng(page, index, width, height) {
  const [download] = await Promise.all([page.waitForEvent("download"), head(page, index).getByText("Save PNG").click()]);
  assert.match(download.suggestedFilename(), /^sonard-.+-\d+\.png$/);
  const bytes = await readFile(await download.path());
  assert.equal(bytes.subarray(1, 4).toString(), "PNG");
  assert.ok(bytes.readUInt32BE(16) >= width && bytes.readUInt32BE(20) >= height, "the picture has its size");
  return bytes;
}

export async function state(page, wanted) {
  await until(`the page to be ${wanted}`, async () => (await page.locator("body").getAttribute("data-state")) === wanted);
}
