// SPDX-License-Identifier: Apache-2.0
// Takes the pictures of docs/page.md from a running daemon.   node screenshots.js HOST:PORT FOLDER
import path from "node:path";
import { framesAdvance, open, PHONE, startBrowser, state } from "./browser.js";

const [address, folder] = process.argv.slice(2);
const WARM_FRAMES = 30;

const browser = await startBrowser();
for (const [name, viewport] of [["page_desk", undefined], ["page_phone", PHONE]]) {
  const page = await open(browser, address, viewport);
  await state(page, "live");
  await framesAdvance(page, 0, WARM_FRAMES);
  await page.screenshot({ path: path.join(folder, `${name}.png`) });
  await page.close();
}
await browser.close();
