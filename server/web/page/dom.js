// SPDX-License-Identifier: Apache-2.0
// Elements from data. Everything that came over the network goes in as text, never as markup.

/** A new element. `options`: text, class, and any other property by its name; data is a map of data attributes. */
export function make(tag, options = {}, ...children) {
  const { text, class: classes, data, ...properties } = options;
  const element = document.createElement(tag);
  if (text !== undefined) {
    element.textContent = text;
  }
  if (classes) {
    element.className = classes;
  }
  Object.assign(element.dataset, data);
  Object.assign(element, properties);
  element.append(...children);
  return element;
}

/** Sets a text only where it changes, so that a selection survives and nothing is laid out in vain. */
export function setText(element, text) {
  if (element.textContent !== text) {
    element.textContent = text;
  }
}

/** Calls `rebuild` when `value` differs from the last one that was shown in this element. */
export function onChange(element, value, rebuild) {
  const key = JSON.stringify(value);
  if (element.shown !== key) {
    element.shown = key;
    rebuild();
  }
}

/** Fills a list of definitions with pairs of name and value. */
export function setPairs(list, pairs) {
  onChange(list, pairs, () =>
    list.replaceChildren(...pairs.map(([name, value]) => make("div", {}, make("dt", { text: name }), make("dd", { text: value })))));
}

/** Shows findings, one an item, and hides the list when there are none. */
export function setFindings(list, findings) {
  list.hidden = findings.length === 0;
  onChange(list, findings, () =>
    list.replaceChildren(...findings.map((finding) => make("li", { text: finding.text, data: { code: finding.code } }))));
}

/** The names of the wire and of rules as words. */
export function words(name) {
  return String(name).replaceAll("_", " ");
}
