// SPDX-License-Identifier: Apache-2.0
// What the daemon says of poses and recording.
import { make, onChange, setPairs } from "./dom.js";
import { angles } from "./pose.js";
import { bytes, count, degrees, duration, number, position } from "./text.js";

const COLUMNS = ["Input", "Publisher", "Poses", "Rate", "Newest", "Gaps", "Jumps", "Clock restarts", "Bad", "Refused"];

function inputRow(input) {
  const cells = [input.input, input.publisher || "none yet", count(input.poses), number(input.rate_hz, 1, "/s"),
    input.age_s === null ? "never" : `${duration(input.age_s)} ago`, count(input.gaps), count(input.jumps), count(input.clock_restarts),
    count(input.bad_messages), count(input.refused)];
  return make("tr", {}, ...cells.map((text, i) => make("td", { text, data: { label: COLUMNS[i] } })));
}

function poseRow(name, pose) {
  const [roll, pitch, yaw] = angles(pose.orientation_wxyz);
  const cells = [["", name], ["Position", position(pose.position_m)], ["Roll", degrees(roll)], ["Pitch", degrees(pitch)], ["Yaw", degrees(yaw)]];
  return make("tr", {}, ...cells.map(([label, text]) => make("td", { text, data: { label } })));
}

function table(columns, rows) {
  return make("table", {}, make("thead", {}, make("tr", {}, ...columns.map((text) => make("th", { text })))), make("tbody", {}, ...rows));
}

/** Pose inputs with their publishers, the vehicle and the bodies that move. */
export function showPoses(body, poses) {
  onChange(body, poses, () => {
    const parts = [];
    if (poses.inputs.length) {
      parts.push(table(COLUMNS, poses.inputs.map(inputRow)));
    } else {
      parts.push(make("p", { class: "none", text: "No pose input is configured. The vehicle does not move." }));
    }
    const posed = [...(poses.vehicle ? [poseRow("vehicle", poses.vehicle)] : []), ...(poses.bodies ?? []).map((one) => poseRow(one.name, one))];
    if (posed.length) {
      parts.push(table(["Pose", "Position (x, y, z)", "Roll", "Pitch", "Yaw"], posed));
    }
    body.replaceChildren(...parts);
  });
}

/** Findings about poses, each with the input it is about. */
export function poseFindings(poses) {
  return poses.inputs.flatMap((input) => (input.findings ?? []).map(({ code, text }) => ({ code, text: `${input.input}: ${text}` })));
}

export function showRecording(panel, list, button, recording) {
  panel.hidden = button.hidden = !recording;
  if (!recording) {
    return;
  }
  button.setAttribute("aria-pressed", recording.on);
  onChange(button, recording.on, () => {
    button.textContent = recording.on ? "Recording" : "Record";
    button.title = recording.on ? "Stop the recording" : "Start the recording";
  });
  const numbers = [["Images", recording.images], ["Images lost", recording.images_lost], ["Logs written", recording.logs_written], ["Logs failed", recording.logs_failed], ["Dropped", recording.dropped]];
  setPairs(list, [
    ["State", recording.on ? "on" : "off"],
    ["Folder", recording.directory],
    ...(recording.bytes === undefined ? [] : [["Written", bytes(recording.bytes)]]),
    ...numbers.filter(([, value]) => value !== undefined).map(([name, value]) => [name, count(value)]),
  ]);
}
