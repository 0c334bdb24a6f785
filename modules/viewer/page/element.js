// SPDX-License-Identifier: BSD-3-Clause
/** Creates an element of the page. */
export function element(tag, text, attributes = {}) {
  const node = document.createElement(tag);
  node.textContent = text;
  Object.entries(attributes).forEach(([name, value]) => node.setAttribute(name, value));
  return node;
}
