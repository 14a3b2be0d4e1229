// SPDX-License-Identifier: Apache-2.0
// Checks manifests with the schemas of Kubernetes, from kubernetes-models.
//   node check_manifests.js FILE.yaml...
// Prints a line or an error for each object; exit code 1 if there is an error.
"use strict";
const fs = require("node:fs");
const yaml = require("js-yaml");

/** A view of a value that notes which of its fields somebody reads. */
function watched(value, path, read) {
  if (typeof value !== "object" || value === null) {
    return value;
  }
  return new Proxy(value, {
    get(target, key, receiver) {
      const inner = Reflect.get(target, key, receiver);
      if (typeof key !== "string" || !Object.hasOwn(target, key)) {
        return inner;
      }
      read.add(`${path}/${key}`);
      return watched(inner, `${path}/${key}`, read);
    },
  });
}

function paths(value, path = "") {
  return typeof value !== "object" || value === null
    ? []
    : Object.keys(value).flatMap((key) => [`${path}/${key}`, ...paths(value[key], `${path}/${key}`)]);
}

/** The class of an object, by its apiVersion and kind. */
function model(object) {
  const [version, group] = String(object.apiVersion).split("/").reverse();
  return require(`kubernetes-models/${group ? `${group}/` : ""}${version}`)[object.kind];
}

/** What is wrong with an object. */
function complaints(object) {
  const Model = model(object);
  if (!Model) {
    return [`${object.apiVersion} has no kind ${object.kind}`];
  }
  const read = new Set();
  try {
    watched(new Model(object), "", read).validate();
  } catch (error) {
    return [error.message];
  }
  // The schemas allow unknown fields, as Kubernetes' do. The validator reads all fields that it knows; others are reported.
  return paths(object).filter((path) => !read.has(path)).map((path) => `${path}: no field of the schema`);
}

let bad = false;
for (const file of process.argv.slice(2)) {
  for (const object of yaml.loadAll(fs.readFileSync(file, "utf8"))) {
    const wrong = complaints(object);
    bad ||= wrong.length > 0;
    console.log([`${object.kind} ${object.metadata?.name}: ${wrong.length ? "bad" : "good"}`, ...wrong].join("\n  "));
  }
}
process.exit(bad ? 1 : 0);
