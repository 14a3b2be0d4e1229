// SPDX-License-Identifier: Apache-2.0
// The page alone, with a simulated daemon (mock_daemon.js), which counts the page's requests.
//   node mock_test.js PAGE        PAGE: the folder server/web/page
import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { framesAdvance, framesOf, head, open, PHONE, readsTarget, savesPng, startBrowser, state, until } from "./browser.js";
import { MockDaemon, TARGETS } from "./mock_daemon.js";

const [folder] = process.argv.slice(2);
const QUIET_MS = 1500;
let browser;
let mock;
let page;

before(async () => (browser = await startBrowser()));
after(() => browser.close());

beforeEach(async () => {
  mock = new MockDaemon(folder);
  await mock.start();
});

afterEach(async () => {
  const complaints = page.complaints;
  await page.close();
  await mock.stop();
  assert.deepEqual(complaints, []);
});

async function openPage(viewport, hash) {
  page = await open(browser, `127.0.0.1:${mock.port}`, viewport, hash);
  await state(page, "live");
}

const quiet = () => new Promise((resolve) => setTimeout(resolve, QUIET_MS));

test("both heads are shown, side by side, and their frames advance", async () => {
  await openPage();
  await Promise.all([framesAdvance(page, 0), framesAdvance(page, 1)]);
  const [left, right] = await Promise.all([head(page, 0).boundingBox(), head(page, 1).boundingBox()]);
  assert.equal(left.y, right.y);
  assert.ok(left.x + left.width <= right.x);
  assert.equal(await head(page, 1).locator("h2").textContent(), "stern");
  assert.match(await head(page, 1).textContent(), /Link faults: 2 % loss/);
  assert.match(await head(page, 0).textContent(), /127\.0\.0\.1:52901/);
});

test("a phone scrolls in one direction only", async () => {
  await openPage(PHONE);
  await framesAdvance(page, 0);
  await page.locator("#world summary").click();
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), PHONE.width);
});

test("pointing at a target reads its range, bearing and value", async () => {
  await openPage();
  await framesAdvance(page, 0);
  // 1.8 degrees a line, four lines in 70 ms: a turn takes 3.5 s.
  await framesAdvance(page, 1, 60);
  await readsTarget(page, 0, TARGETS[0], 20);
  await readsTarget(page, 1, TARGETS[1], 12);
  for (const index of [0, 1]) {
    await head(page, index).getByText("B-scan").click();
    await framesAdvance(page, index, 2);
    await readsTarget(page, index, TARGETS[index], [20, 12][index]);
  }
});

test("gain and colours change the picture and the bar", async () => {
  await openPage();
  await framesAdvance(page, 0);
  const brightness = () => head(page, 0).locator("canvas.bar").evaluate((bar) => {
    const { data } = bar.getContext("2d").getImageData(bar.width / 2, 0, 1, 1);
    return [...data.slice(0, 3)];
  });
  const amber = await brightness();
  await head(page, 0).locator("input[type=range]").fill("20");
  await until("a brighter bar", async () => (await brightness())[1] > amber[1]);
  await head(page, 0).locator("select").selectOption("Grey");
  await until("a grey bar", async () => Math.max(...(await brightness())) - Math.min(...(await brightness())) < 8);
});

test("a viewer that comes late sees the last ping, and how old it is", async () => {
  mock.becomeIdle(75);
  await openPage();
  await until("the last ping", async () => (await framesOf(page, 0)) >= 1);
  await until("the age of the ping", async () => /^Last ping 7[5-9] s ago\.$/.test(await head(page, 0).locator(".age").textContent()));
  assert.ok(await head(page, 0).locator(".empty").isHidden());
});

test("an empty picture says what it waits for: a client, a pose, a newer pose, or the next ping", async () => {
  mock.becomeIdle();
  const says = (text) => until(text, async () => (await head(page, 0).locator(".empty").textContent()).includes(text));
  const clients = mock.clients;
  mock.clients = [];
  await openPage();
  await says("No client has connected. Start your driver or sonarview. This sonar listens on udp 127.0.0.2:52900.");
  const stale = "The head does not ping: the pose is stale: the newest one is 6.8 s old.";
  Object.assign(mock, { clients, findings: [{ code: "no_pose", text: "No pose of the vehicle has arrived." }] });
  await says("A client requests pings, but no pose of the vehicle has arrived. Send poses to pose stream udp 127.0.0.1:14600.");
  mock.findings = [{ code: "stale_pose", text: stale }];
  await says(`${stale} Send poses to pose stream udp 127.0.0.1:14600.`);
  const other = "A client sends commands for sonar ID 514, but this head has sonar ID 513.";
  mock.findings = [{ code: "misaddressed", text: other }];
  await says(other);
  mock.findings = [{ code: "above_surface", text: "The sonar is 1 m above the water surface." }];
  await says("A client is connected. Its next ping starts the picture.");
  assert.ok(await head(page, 0).locator(".empty").isVisible());
});

// By the geometry of the picture: a fan of 120 degrees is 2 sin 60 = 1.73 times as wide as high, a turn is as wide as high.
for (const [name, viewport, most] of [["a desk", undefined, 0.8], ["a phone", PHONE, 0.72]]) {
  test(`a picture fills its box on ${name}`, async () => {
    await openPage(viewport);
    for (const index of [0, 1]) {
      await head(page, index).scrollIntoViewIfNeeded();
      await framesAdvance(page, index, index ? 60 : 2);
      const share = await head(page, index).locator("canvas.echoes").evaluate((canvas) => {
        const { width, height } = canvas;
        const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
        const drawn = { left: width, right: 0, top: height, bottom: 0 };
        for (let i = 3, place = 0; i < data.length; i += 4, ++place) {
          if (data[i]) {
            drawn.left = Math.min(drawn.left, place % width);
            drawn.right = Math.max(drawn.right, place % width);
            drawn.top = Math.min(drawn.top, Math.floor(place / width));
            drawn.bottom = Math.max(drawn.bottom, Math.floor(place / width));
          }
        }
        return { across: (drawn.right - drawn.left) / width, up: (drawn.bottom - drawn.top) / height };
      });
      assert.ok(share.up > most, `head ${index} fills ${share.up} of the height`);
      assert.ok(share.across > most, `head ${index} fills ${share.across} of the width`);
    }
  });
}

test("a frozen picture stays and asks for nothing", async () => {
  await openPage();
  await framesAdvance(page, 0);
  await head(page, 0).locator(".freeze").click();
  await quiet();
  const [frames, wants] = [await framesOf(page, 0), mock.wants[0]];
  await framesAdvance(page, 1);
  assert.equal(await framesOf(page, 0), frames);
  assert.equal(mock.wants[0], wants);
  await head(page, 0).locator(".freeze").click();
  await framesAdvance(page, 0);
});

test("the picture is saved as PNG", async () => {
  await openPage();
  await framesAdvance(page, 0);
  await savesPng(page, 0, 600, 400);
});

test("a hidden tab asks for nothing, and goes on when it is seen", async () => {
  await openPage();
  await framesAdvance(page, 0);
  const show = (visibility) => page.evaluate((value) => {
    Object.defineProperty(document, "visibilityState", { value, configurable: true });
    document.dispatchEvent(new Event("visibilitychange"));
  }, visibility);
  await show("hidden");
  await quiet();
  const asked = [...mock.wants, mock.statusWants];
  await quiet();
  assert.deepEqual([...mock.wants, mock.statusWants], asked);
  await show("visible");
  await framesAdvance(page, 0);
});

test("a head that is scrolled out of sight asks for nothing", async () => {
  await openPage(PHONE);
  await framesAdvance(page, 0, 10);
  assert.equal(mock.wants[1], 0);
  await head(page, 1).scrollIntoViewIfNeeded();
  await framesAdvance(page, 1);
});

test("the world is fetched and drawn when its panel is opened, not before", async () => {
  await openPage();
  await framesAdvance(page, 0);
  assert.equal(mock.worldAsked, 0);
  await page.locator("#world summary").click();
  await until("both views", async () => (await page.locator("#views canvas").count()) === 2);
  const coloured = (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.some((value, i) => i % 4 === 0 && value > 200);
  };
  await until("something drawn", () => page.locator("#views canvas").first().evaluate(coloured));
  assert.equal(mock.worldAsked, 1);
});

test("findings are shown as the text that they are", async () => {
  mock.findings = [{ code: "above_surface", text: "The sonar is 25.6 m above the surface (is z down?)." }];
  mock.poseFindings = [{ code: "two_publishers", text: "<img src=x onerror=alert(1)>" }];
  await openPage();
  await head(page, 0).locator(".findings li").waitFor();
  assert.equal(await head(page, 0).locator(".findings").textContent(), mock.findings[0].text);
  assert.match(await page.locator("#pose-findings").textContent(), /<img src=x/);
  assert.equal(await page.locator("#pose-findings img").count(), 0);
});

test("the recording is switched, with the token where one is needed", async () => {
  await openPage();
  await page.locator("#record").click();
  await until("the recording to be on", () => mock.recordingOn);
  await until("the button to say so", async () => (await page.locator("#record").textContent()) === "Recording");
  mock.token = "a secret";
  await page.locator("#record").click();
  await until("why not", async () => /token/.test(await page.locator("#message").textContent()));
  await page.close();
  await openPage(undefined, "#token=a%20secret");
  await until("the button", async () => (await page.locator("#record").textContent()) === "Recording");
  await page.locator("#record").click();
  await until("the recording to be off", () => !mock.recordingOn);
  assert.equal(await page.evaluate(() => location.hash), "");
});

test("a daemon that was lost is said to be, and regained", async () => {
  await openPage();
  await framesAdvance(page, 0);
  const { port } = mock;
  await mock.stop();
  await state(page, "lost");
  assert.match(await page.locator("#lost").textContent(), /No connection/);
  await mock.start(port);
  await state(page, "live");
  assert.ok(await page.locator("#lost").isHidden());
  await framesAdvance(page, 0);
});
