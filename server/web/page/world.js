// SPDX-License-Identifier: Apache-2.0
// The panel with the views of the world. Nothing is fetched or drawn while it is closed.
import { make, setText } from "./dom.js";
import { WorldView } from "./world_view.js";

export class WorldPanel {
  /** `details`: the panel; `body`: where its contents go. */
  constructor(details, body) {
    this.details = details;
    this.body = body;
    this.note = make("p", { class: "none", text: "Loading the world." });
    this.near = make("select", {}, make("option", { value: "whole", text: "Whole world" }), make("option", { value: "near", text: "Around the sonars" }));
    this.near.setAttribute("aria-label", "What the views show");
    this.near.addEventListener("change", () => this.show());
    details.addEventListener("toggle", () => this.show());
  }

  update(status) {
    this.status = status;
    this.show();
  }

  /** The daemon is another one now: its world may be, too. */
  forget() {
    this.world = this.views = null;
  }

  show() {
    if (!this.details.open || !this.status) {
      return;
    }
    if (!this.world) {
      this.fetch();
      return;
    }
    for (const view of this.views) {
      view.show(this.world, this.status, this.near.value === "near");
    }
  }

  async fetch() {
    if (this.fetching) {
      return;
    }
    this.fetching = true;
    this.body.replaceChildren(this.note);
    try {
      const answer = await fetch("api/world");
      if (!answer.ok) {
        throw new Error(`the daemon returned status ${answer.status}`);
      }
      this.world = await answer.json();
      this.views = [
        new WorldView("From above, east to the right (m)", [0, 1], "api/world/top.png"),
        new WorldView("From the side, east to the right (m)", [0, 2], "api/world/side.png"),
      ];
      const bodies = this.world.bodies.length;
      this.body.replaceChildren(
        make("p", { class: "views-head" }, make("span", { text: `${this.world.name}, ${bodies} ${bodies === 1 ? "body" : "bodies"}` }), this.near),
        ...this.views.map((view) => view.element));
    } catch (error) {
      setText(this.note, `Cannot load the world: ${error.message}`);
    }
    this.fetching = false;
    if (this.world) {
      this.show();
    }
  }
}
