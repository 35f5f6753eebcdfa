// Elements of the page: finding, making, filling.
export const TABS = ["parameters", "diagnostics", "inspect", "compare", "cost", "export"];

export const $ = (id) => document.getElementById(id);

// Make an element. Attributes "on..." are listeners, true is an attribute without a value.
export function tag(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value != null) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

// Fill a list of choices, unless the user has it open.
export function fillSelect(select, names, chosen) {
  if (document.activeElement === select && select.options.length) return;
  select.replaceChildren(...names.map((n) => tag("option", { selected: n === chosen }, n)));
}

export function showNote(text) {
  $("note").textContent = text;
  $("note").hidden = !text;
}

export function showTab(name) {
  for (const other of TABS) $(other).hidden = other !== name;
  for (const button of $("tabs").children)
    button.setAttribute("aria-selected", button.dataset.tab === name);
}

// Address of a PNG that JSON carries as hexadecimal digits.
export function imageOfHex(hex) {
  const bytes = new Uint8Array(hex.match(/../g).map((pair) => parseInt(pair, 16)));
  return URL.createObjectURL(new Blob([bytes], { type: "image/png" }));
}
