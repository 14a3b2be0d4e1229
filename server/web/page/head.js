// SPDX-License-Identifier: Apache-2.0
// One head on the page: its picture with the controls, and what the daemon says of it.
import { mapNames } from "./colour.js";
import { make, onChange, setFindings, setPairs, setText, words } from "./dom.js";
import { Picture } from "./picture.js";
import { count, duration, milliseconds, number } from "./text.js";

const OLD_PICTURE_MS = 3000;
const STAGES = ["visibility", "binning", "multipath", "azimuth_pattern", "pulse", "receiver"];  // in the order of a ping
const LEAST_STAGE_MS = 0.05;

function button(text, title, press) {
  const element = make("button", { type: "button", text, title });
  element.addEventListener("click", () => press(element));
  return element;
}

export class Head {
  /** `changed` is called when what this head wants may have changed. */
  constructor(index, changed) {
    this.index = index;
    this.changed = changed;
    this.frozen = false;
    this.frames = 0;  // that were drawn
    this.inView = false;  // until the browser says otherwise
    this.picture = new Picture((ping) => this.drawn(ping));
    this.title = make("h2");
    this.type = make("span", { class: "type" });
    this.fault = make("span", { class: "fault", hidden: true });
    this.findings = make("ul", { class: "findings", hidden: true });
    this.empty = make("p", { class: "empty" });
    this.age = make("p", { class: "age", hidden: true });
    this.picture.stage.append(this.empty, this.age);
    this.facts = make("dl", { class: "facts" });
    this.makeMore();
    this.element = make("article", { class: "head", data: { head: index, frames: 0 } },
      make("div", { class: "look" }, make("header", {}, this.title, this.type, this.fault), this.findings, this.picture.stage,
        this.picture.legend, this.controls()),
      make("div", { class: "said" }, this.facts, this.stages, this.clients, this.skipped, this.settings, this.counters));
    new IntersectionObserver((entries) => {
      this.inView = entries.at(-1).isIntersecting;
      changed();
    }).observe(this.picture.stage);
  }

  controls() {
    const map = make("select", { title: "Colours" }, ...mapNames.map((name) => make("option", { text: name })));
    map.setAttribute("aria-label", "Colours");
    map.addEventListener("change", () => this.picture.set("map", map.value));
    const shown = make("output", { text: "0 dB" });
    const gain = make("input", { type: "range", min: -20, max: 40, step: 1, value: 0 });
    gain.setAttribute("aria-label", "Gain of the picture in decibels");
    gain.addEventListener("input", () => {
      setText(shown, number(Number(gain.value), 0, "dB"));
      this.picture.set("gain_db", Number(gain.value));
    });
    return make("div", { class: "controls" }, this.modes(),
      make("label", { class: "gain", title: "Gain of the picture only; it does not change the sonar" }, "Gain", gain, shown), map,
      this.freezeButton(), button("Save PNG", "Save the current picture", () => this.save()));
  }

  modes() {
    const group = make("div", { class: "modes" });
    group.setAttribute("role", "group");
    const choose = (chosen) => {
      for (const one of group.children) {
        one.setAttribute("aria-pressed", one === chosen);
      }
      this.picture.set("mode", chosen.value);
    };
    const fan = button("Fan", "The scene from above", choose);
    const polar = button("B-scan", "Bearing to the right, range upwards", choose);
    fan.value = "fan";
    polar.value = "polar";
    group.append(fan, polar);
    choose(fan);
    return group;
  }

  freezeButton() {
    const freeze = button("Freeze", "Stop updating the picture", () => {
      this.frozen = !this.frozen;
      freeze.setAttribute("aria-pressed", this.frozen);
      setText(freeze, this.frozen ? "Frozen" : "Freeze");
      this.changed();
    });
    freeze.classList.add("freeze");
    freeze.setAttribute("aria-pressed", false);
    return freeze;
  }

  makeMore() {
    this.stages = make("div", { class: "stages" });
    this.clients = make("div", { class: "clients" });
    this.lists = {};
    for (const [name, title] of [["skipped", "Skipped work"], ["settings", "Settings"], ["counters", "Counters"]]) {
      const list = make("dl", { class: name === "skipped" ? "rules" : "pairs" });
      const summary = make("summary", { text: title });
      this[name] = make("details", { class: "more", hidden: true }, summary, list);
      this.lists[name] = { list, summary, title };
    }
  }

  /** The frame this head wants now, or null. */
  wanted() {
    return this.frozen || !this.inView ? null : { head: this.index, max_rows: this.picture.wantedRows };
  }

  take(ping) {
    this.pingAt = performance.now() - 1000 * (ping.age_s ?? 0);
    if (this.frozen) {
      return;
    }
    this.empty.hidden = true;
    this.picture.take(ping);
    this.tick();
  }

  /** A ping is on the screen now. */
  drawn(ping) {
    Object.assign(this.element.dataset, { frames: ++this.frames, ping: ping.number, bin: ping.bin_m });
    this.changed();
  }

  /** Says how old a picture is when nothing new comes. */
  tick() {
    const age = performance.now() - this.pingAt;
    const old = age > OLD_PICTURE_MS && !this.frozen && this.inView;
    this.age.hidden = !old;
    if (old) {
      setText(this.age, `Last ping ${duration(age / 1000)} ago.`);
    }
  }

  /** Says what the first picture waits for. */
  updateEmpty({ clients = [], serves = [], findings = [] }, poses) {
    const inputs = poses.inputs.map((input) => input.input).join(", ");
    const send = `Send poses to ${inputs || "a configured input (poses)"}.`;
    const finding = (code) => findings.find((found) => found.code === code);
    if (!clients.length) {
      setText(this.empty, `No client has connected. Start your driver or sonarview. This sonar listens on ${serves.join(", ")}.`);
    } else if (finding("no_pose")) {
      setText(this.empty, `A client requests pings, but no pose of the vehicle has arrived. ${send}`);
    } else if (finding("stale_pose")) {
      setText(this.empty, `${finding("stale_pose").text} ${send}`);
    } else if (finding("misaddressed")) {
      setText(this.empty, finding("misaddressed").text);
    } else {
      setText(this.empty, "A client is connected. Its next ping starts the picture.");
    }
  }

  update(status, poses) {
    this.name = status.name;
    this.picture.stage.dataset.scanning = status.scanning;
    setText(this.title, status.name);
    setText(this.type, words(status.type));
    this.fault.hidden = !status.link_faults;
    setText(this.fault, status.link_faults ? `Link faults: ${status.link_faults}` : "");
    setFindings(this.findings, status.findings ?? []);
    this.updateEmpty(status, poses);
    this.updateFacts(status);
    onChange(this.stages, status.stages_ms, () => this.updateStages(status.stages_ms ?? {}));
    onChange(this.clients, [status.serves, status.clients], () => this.updateClients(status));
    this.updateLists(status);
    this.tick();
  }

  updateFacts(status) {
    const facts = [
      ["Rate", number(status.pings_per_s, 1, "/s")],
      ["Render", milliseconds(status.render_ms)],
      ["Latency", milliseconds(status.latency_ms)],
      ["Pose age", milliseconds(status.pose_age_ms)],
      ["Range", status.range_m > 0 ? number(status.range_m, status.range_m < 10 ? 2 : 1, "m") : number(null)],
      ["Pings", count(status.pings)],
    ];
    if (status.pings_without_pose > 0) {
      facts.push(["Without pose", count(status.pings_without_pose)]);
    }
    setPairs(this.facts, facts);
  }

  updateStages(stages) {
    const names = [...STAGES, ...Object.keys(stages).filter((name) => !STAGES.includes(name))];
    const all = names.map((name) => [name, stages[name]]).filter(([, spent]) => spent >= LEAST_STAGE_MS);
    const total = all.reduce((sum, [, spent]) => sum + spent, 0);
    if (!total) {
      this.stages.replaceChildren();
      return;
    }
    const bar = make("div", { class: "stack" });
    const list = make("ul");
    all.forEach(([name, spent]) => {
      const place = names.indexOf(name);
      const part = make("i", { data: { stage: place } });
      part.style.flexGrow = spent / total;
      bar.append(part);
      list.append(make("li", { data: { stage: place } }, words(name), make("b", { text: milliseconds(spent) })));
    });
    this.stages.replaceChildren(make("h3", { text: "Rendering time of a ping" }), bar, list);
  }

  updateClients({ serves = [], clients = [] }) {
    const lines = clients.map((client) => make("li", {}, make("code", { text: client.address }),
      make("span", { text: `${count(client.messages)} messages, the last ${duration(client.idle_s)} ago` })));
    if (!lines.length) {
      lines.push(make("li", { class: "none", text: "No client yet." }));
    }
    this.clients.replaceChildren(make("h3", { text: clients.length === 1 ? "Client" : "Clients" }), make("ul", {}, ...lines),
      make("p", { class: "serves" }, "Listens on ", ...serves.flatMap((place, i) => [i ? ", " : "", make("code", { text: place })])));
  }

  updateLists(status) {
    const of = { skipped: status.skipped ?? [], settings: status.settings ?? [], counters: status.counters ?? [] };
    const pairs = {
      skipped: of.skipped.map(({ rule, count: times, unit, why }) => [`${words(rule)}: ${count(times)}${unit ? ` ${unit}` : ""}`, why]),
      settings: of.settings.map(({ name, value }) => [words(name), value]),
      counters: of.counters.map(({ name, value }) => [words(name), count(value)]),
    };
    for (const [name, { list, summary, title }] of Object.entries(this.lists)) {
      this[name].hidden = pairs[name].length === 0;
      setText(summary, `${title} (${pairs[name].length})`);
      if (this[name].open) {
        setPairs(list, pairs[name]);
      } else {
        this[name].ontoggle = () => setPairs(list, pairs[name]);
      }
    }
  }

  async save() {
    if (!this.picture.ping) {
      return;
    }
    const { number: ping } = this.picture.ping;
    const blob = await this.picture.png(`${this.name}   ping ${ping}   ${number(this.picture.projection.range_m, 1, "m")}   ${new Date().toISOString().slice(0, 19).replace("T", " ")} UTC`);
    const link = make("a", { href: URL.createObjectURL(blob), download: `sonard-${this.name}-${ping}.png` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }
}
