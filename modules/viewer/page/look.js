// SPDX-License-Identifier: BSD-3-Clause
// Settings of the display: layers on and off, colours, the height at which the scene is cut. They are stored in this browser.
import {HEIGHTS_M, rampCss, shared} from "./colors.js";
import {element} from "./element.js";

/** A setting that this browser remembers; null if there is none, or if it may not remember anything. */
function recall(key) {
  try {
    return localStorage.getItem(key);
  } catch (error) {
    return null;
  }
}

function remember(key, value) {
  try {
    localStorage.setItem(key, value);
  } catch (error) {
    console.info(`not remembered: ${error.message}`);
  }
}

/** Creates a check box for each layer. `changed()` is called when the image must be redrawn. */
export function makeLayerList(fieldset, layers, changed) {
  for (const [topic, {name, layer, off, swatch}] of layers) {
    const key = `layer:${topic}`;
    const box = element("input", "", {type: "checkbox", "data-topic": topic});
    box.checked = (recall(key) ?? (off ? "off" : "on")) === "on";
    layer.visible = box.checked;
    box.addEventListener("change", () => {
      layer.visible = box.checked;
      remember(key, box.checked ? "on" : "off");
      changed();
    });
    const label = element("label", "");
    const color = element("span", "", {class: "swatch", "aria-hidden": "true"});
    color.style.background = swatch === "ramp" ? rampCss() : swatch;
    label.append(box, color, name);
    fieldset.append(label);
  }
}

/** The dark or light theme of scene and page. `auto` follows the browser. */
export function makeTheme(select, view) {
  const light = window.matchMedia("(prefers-color-scheme: light)");
  const apply = () => {
    const theme = select.value === "auto" ? (light.matches ? "light" : "dark") : select.value;
    document.documentElement.dataset.theme = theme;
    view.setTheme(theme);
  };
  const kept = recall("look:theme");
  select.value = [...select.options].some(({value}) => value === kept) ? kept : select.value;
  select.addEventListener("change", () => {
    remember("look:theme", select.value);
    apply();
  });
  light.addEventListener("change", apply);
  apply();
}

/** The settings of colours and ceiling, and the legend. */
export function makeLook({color, ceiling, low, high, ramp}, changed) {
  const apply = () => {
    shared.byAge.value = color.value === "age";
    shared.ceilingM.value = Number(ceiling.value);
    [low.textContent, high.textContent] = shared.byAge.value ? ["oldest", "newest"] : HEIGHTS_M.map((height) => `${height} m`);
    changed();
  };
  for (const select of [color, ceiling]) {
    const key = `look:${select.id}`;
    const kept = recall(key);
    select.value = [...select.options].some(({value}) => value === kept) ? kept : select.value;
    select.addEventListener("change", () => {
      remember(key, select.value);
      apply();
    });
  }
  ramp.style.background = rampCss();
  apply();
}
