// SPDX-License-Identifier: Apache-2.0
// Programs that tests start.
import { spawn } from "node:child_process";

/** Starts a program and adds it to `running`; its `output` collects what it says. */
export function startProgram(file, options, running) {
  const child = spawn(file, options, { stdio: ["ignore", "pipe", "pipe"] });
  child.output = "";
  for (const stream of [child.stdout, child.stderr]) {
    stream.setEncoding("utf-8").on("data", (text) => (child.output = (child.output + text).slice(-20000)));
  }
  running.push(child);
  return child;
}
