// The parameters: a group a camera, light, material and pass; a change is sent as it is made.
import { send } from "./connection.js";
import { $, tag } from "./dom.js";

const open = new Set();
let built = "";

const hex = (value) => "#" + value.slice(0, 3)
  .map((v) => Math.round(Math.min(Math.max(v, 0), 1) * 255).toString(16).padStart(2, "0")).join("");

function set(control, value, more = false) {
  send({ do: "set", key: control.key, value, more });
}

function number(control, index, more) {
  const input = tag("input", {
    type: "number", step: "any", value: control.value[index],
    "aria-label": `${control.group} ${control.label} ${index}`,
    min: control.minimum, max: control.maximum,
  });
  input.onchange = () => {
    const value = [...now(control.key).value];
    value[index] = Number(input.value);
    set(control, value, more);
  };
  return input;
}

let current = {};
const now = (key) => current[key];

function slider(control) {
  if (control.minimum == null || control.maximum == null || control.value.length > 1) return [];
  const step = control.kind === "whole" ? 1 : (control.maximum - control.minimum) / 200;
  const input = tag("input", {
    type: "range", min: control.minimum, max: control.maximum, step, value: control.value[0],
    "aria-label": `${control.label} slider`,
  });
  let dragging = false;
  input.oninput = () => { set(control, [Number(input.value)], dragging); dragging = true; };
  input.onchange = () => { dragging = false; };
  return [input];
}

function field(control) {
  if (control.kind === "flag") {
    const box = tag("input", { type: "checkbox", checked: control.value[0], "aria-label": control.label });
    box.onchange = () => set(control, [box.checked]);
    return [box];
  }
  if (control.kind === "choice") {
    const select = tag("select", { "aria-label": control.label },
      ...control.choices.map((c) => tag("option", { selected: c === control.value[0] }, c)));
    select.onchange = () => set(control, [select.value]);
    return [select];
  }
  const numbers = tag("div", { class: "numbers" }, ...control.value.map((_, i) => number(control, i)));
  if (control.kind !== "colour") return [numbers, ...slider(control)];
  const colour = tag("input", { type: "color", value: hex(control.value), "aria-label": `${control.group} ${control.label}` });
  let dragging = false;
  colour.oninput = () => {
    const rgb = [1, 3, 5].map((i) => parseInt(colour.value.slice(i, i + 2), 16) / 255);
    const rounded = rgb.map((v) => Number(v.toFixed(4)));
    set(control, [...rounded, ...now(control.key).value.slice(3)], dragging);
    dragging = true;
  };
  colour.onchange = () => { dragging = false; };
  return [colour, numbers];
}

function row(control) {
  const note = control.saved ? "" : " A model defines it: saving leaves it out.";
  return tag("div", { class: `control${control.saved ? "" : " loose"}`, "data-key": control.key,
    title: control.doc + note }, tag("span", {}, control.label), tag("div", {}, ...field(control)));
}

export function controls(content) {
  current = Object.fromEntries(content.controls.map((c) => [c.key, c]));
  const shape = JSON.stringify(content.controls.map((c) => [c.key, c.kind]));
  if (shape !== built) {
    built = shape;
    build(content);
  }
  const changed = new Set(content.changed);
  for (const line of $("parameters").querySelectorAll(".control")) {
    const control = current[line.dataset.key];
    line.classList.toggle("changed", changed.has(control.key));
    refresh(line, control);
  }
}

// What is being typed in is left alone.
function refresh(line, control) {
  const inputs = [...line.querySelectorAll(".numbers input")];
  inputs.forEach((input, i) => {
    if (input !== document.activeElement) input.value = Number(Number(control.value[i]).toPrecision(6));
  });
  for (const input of line.querySelectorAll("input[type=range]")) {
    if (input !== document.activeElement) input.value = control.value[0];
  }
  for (const input of line.querySelectorAll("input[type=color]")) {
    if (input !== document.activeElement) input.value = hex(control.value);
  }
  for (const input of line.querySelectorAll("input[type=checkbox]")) input.checked = control.value[0];
  for (const input of line.querySelectorAll("select")) input.value = control.value[0];
}

function build(content) {
  const groups = new Map();
  for (const control of content.controls) {
    if (!groups.has(control.group)) groups.set(control.group, []);
    groups.get(control.group).push(control);
  }
  if (!built.includes("first")) [...groups.keys()].slice(0, 1).forEach((g) => open.add(g));
  $("parameters").replaceChildren(
    tag("p", { class: "soft" }, "Drag: orbit. Right: look. Shift: pan. Wheel: nearer. WASD, QE: fly."),
    ...[...groups].map(([name, listed]) => {
      const made = tag("details", { open: open.has(name) }, tag("summary", {}, name), ...listed.map(row));
      made.addEventListener("toggle", () => (made.open ? open.add(name) : open.delete(name)));
      return made;
    }));
}
