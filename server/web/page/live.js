// SPDX-License-Identifier: Apache-2.0
// The connection to the daemon. Frames and status come only when they were asked for, one at a time: a page that is
// hidden asks for nothing, and a slow one gets what is newest.
import { readPing } from "./frame.js";

const FIRST_RETRY_MS = 500;
const LAST_RETRY_MS = 3000;
const SILENCE_MS = 6000;  // a status comes every half second; without any for so long the daemon is gone

export class Live {
  /**
   * `handlers`: status(status), ping(ping), error(text), state("connecting" | "live" | "lost"), and wanted(), the
   * heads whose next frame is wanted now as [{head, max_rows}].
   */
  constructor(handlers) {
    this.handlers = handlers;
    this.owed = new Set();  // heads that were asked for a frame which has not come
    this.statusOwed = false;
    this.retryMs = FIRST_RETRY_MS;
    document.addEventListener("visibilitychange", () => this.visibilityChanged());
    setInterval(() => this.watch(), 1000);
    this.connect();
  }

  connect() {
    clearTimeout(this.retry);
    const address = new URL("api/live", location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    address.hash = "";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.opened();
    socket.onmessage = (event) => this.received(event.data);
    socket.onclose = () => this.closed(socket);
    this.socket = socket;
    this.lastWord = performance.now();
  }

  opened() {
    this.retryMs = FIRST_RETRY_MS;
    this.owed.clear();
    this.statusOwed = false;
    this.ask();
  }

  closed(socket) {
    if (socket !== this.socket) {
      return;
    }
    this.socket = null;
    this.handlers.state("lost");
    this.retry = setTimeout(() => this.connect(), this.retryMs);
    this.retryMs = Math.min(LAST_RETRY_MS, 1.5 * this.retryMs);
  }

  /** Asks for what is wanted and not yet under way. Call it whenever that may have changed. */
  ask() {
    if (this.socket?.readyState !== WebSocket.OPEN || document.visibilityState === "hidden") {
      return;
    }
    if (!this.statusOwed) {
      this.statusOwed = true;
      this.send({ type: "want_status" });
    }
    for (const { head, max_rows } of this.handlers.wanted()) {
      if (!this.owed.has(head)) {
        this.owed.add(head);
        this.send({ type: "want", head, max_rows });
      }
    }
  }

  send(message) {
    this.socket.send(JSON.stringify(message));
  }

  received(data) {
    this.lastWord = performance.now();
    if (typeof data === "string") {
      this.receivedText(JSON.parse(data));
    } else {
      this.receivedPing(data);
    }
  }

  receivedText(message) {
    if (message.type === "status") {
      this.statusOwed = false;
      this.handlers.state("live");
      this.handlers.status(message.status);
      this.ask();
    } else if (message.type === "error") {
      this.handlers.error(message.text);
    }
  }

  receivedPing(data) {
    try {
      const ping = readPing(data);
      this.owed.delete(ping.head);
      this.handlers.ping(ping);
    } catch (error) {
      this.owed.clear();  // whose frame it was is not known; all are asked for again with the next status
      this.handlers.error(error.message);
    }
  }

  visibilityChanged() {
    this.lastWord = performance.now();
    if (document.visibilityState === "visible" && !this.socket) {
      this.connect();
    }
    this.ask();
  }

  /** A network that went away says nothing: where no status comes although one was asked for, connect anew. */
  watch() {
    const silent = performance.now() - this.lastWord > SILENCE_MS;
    if (this.socket && silent && document.visibilityState === "visible") {
      const old = this.socket;
      old.onmessage = null;
      old.close();
      this.closed(old);
    }
  }
}
