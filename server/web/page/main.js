// SPDX-License-Identifier: Apache-2.0
// The page: what comes over the connection goes to the heads and panels, and what those want is asked for.
import { make, onChange, setFindings, setText } from "./dom.js";
import { Head } from "./head.js";
import { Live } from "./live.js";
import { poseFindings, showPoses, showRecording } from "./panels.js";
import { duration } from "./text.js";
import { WorldPanel } from "./world.js";

const MESSAGE_MS = 8000;
const STATES = { connecting: "Connecting", live: "Live", lost: "No connection" };
const at = (id) => document.getElementById(id);

const world = new WorldPanel(at("world"), at("views"));
let heads = [];
let uptime_s = 0;

/** A token lets a page from elsewhere change state. It comes behind the address, #token=..., and is kept for this tab. */
function takeToken() {
  const given = new URLSearchParams(location.hash.slice(1)).get("token");
  if (given) {
    sessionStorage.setItem("token", given);
    history.replaceState(null, "", location.pathname);
  }
  return sessionStorage.getItem("token");
}
const token = takeToken();

let messageTimer;
function say(text) {
  at("message").hidden = false;
  setText(at("message"), text);
  clearTimeout(messageTimer);
  messageTimer = setTimeout(() => (at("message").hidden = true), MESSAGE_MS);
}

function showState(state) {
  document.body.dataset.state = state;
  setText(at("state"), STATES[state]);
  at("lost").hidden = state !== "lost";
  if (state === "lost") {
    setText(at("lost"), `No connection to the daemon at ${location.host}. The page shows old values until the daemon answers again.`);
    document.title = "sonard (no connection)";
  }
}

/** The heads of a daemon never change while it runs; another one may have others. */
function showHeads(all, poses) {
  onChange(at("heads"), all.map((head) => [head.name, head.type]), () => {
    heads = all.map((_, index) => new Head(index, () => live.ask()));
    at("heads").dataset.count = heads.length;
    at("heads").replaceChildren(...heads.map((head) => head.element));
  });
  all.forEach((status, index) => heads[index].update(status, poses));
}

function showStatus(status) {
  if (status.uptime_s < uptime_s) {
    world.forget();
  }
  uptime_s = status.uptime_s;
  document.title = `${status.heads.map((head) => head.name).join(", ")} | sonard`;
  onChange(at("about"), [status.version, status.configuration, status.engine, status.world?.name], () =>
    at("about").replaceChildren(...[status.version, status.configuration, status.world?.name, status.engine].filter(Boolean).map((text) => make("span", { text }))));
  at("state").title = `Uptime of the daemon: ${duration(status.uptime_s)}`;
  showHeads(status.heads, status.poses);
  setFindings(at("pose-findings"), poseFindings(status.poses));
  if (at("poses").open) {
    showPoses(at("pose-body"), status.poses);
  }
  showRecording(at("recording"), at("recording-body"), at("record"), status.recording);
  world.update(status);
}

const WHY = {
  403: "Only pages on the daemon's machine, or pages opened with the token, can switch the recording.",
  409: "No recording is configured.",
};

async function switchRecording() {
  const on = at("record").getAttribute("aria-pressed") !== "true";
  const headers = { "Content-Type": "application/json", ...(token ? { Authorization: `Bearer ${token}` } : {}) };
  try {
    const answer = await fetch("api/recording", { method: "POST", headers, body: JSON.stringify({ on }) });
    if (!answer.ok) {
      say(WHY[answer.status] ?? `The daemon returned status ${answer.status}.`);
    }
  } catch {
    say("The daemon does not answer.");
  }
}

const live = new Live({
  status: showStatus,
  ping: (ping) => heads[ping.head]?.take(ping),
  error: say,
  state: showState,
  wanted: () => heads.map((head) => head.wanted()).filter(Boolean),
});
at("record").addEventListener("click", switchRecording);
setInterval(() => heads.forEach((head) => head.tick()), 1000);
