// Two pictures behind a slider, with their difference and its figures.
import { fetchOrNote, state } from "./connection.js";
import { $, fillSelect, imageOfHex, tag } from "./dom.js";

let part = 0.5, label = "", timer = null;

function place() {
  $("other").style.clipPath = `inset(0 0 0 ${part * 100}%)`;
  $("bar").style.left = `${part * 100}%`;
}

async function take(query, text) {
  const params = new URLSearchParams({ ...query, label: text });
  const answer = await fetchOrNote(`keep?${params}`, { method: "POST" });
  $("other").src = URL.createObjectURL(await answer.blob());
  label = text;
  $("other").hidden = $("bar").hidden = false;
  place();
  $("against").textContent = `right of the bar: ${label}`;
  await figures();
}

async function figures() {
  if ($("other").hidden) return;
  const found = await (await fetchOrNote("compare")).json();
  const rows = Object.entries(found.figures).map(([name, value]) => tag("tr", {}, tag("th", {}, name),
    tag("td", { "data-figure": name }, value == null ? "–" : Number(value.toPrecision(4)).toString())));
  $("figures").replaceChildren(...rows);
  $("difference").src = imageOfHex(found.difference);
}

export const compare = {
  begin() {
    const pipelines = tag("select", { id: "other-pipeline", "aria-label": "other pipeline" });
    const effects = tag("select", { id: "other-effects", "aria-label": "other effects" },
      ...["(same)", "auto", "all", "none"].map((n) => tag("option", {}, n)));
    const attempt = (work) => () => work().catch(() => {});
    $("compare").append(
      tag("div", { class: "row" }, tag("button", { id: "keep", onclick: attempt(() => take({}, "the picture kept")) },
        "Keep this picture"), tag("span", { class: "soft" }, "then change something")),
      tag("div", { class: "row" }, "or render ", pipelines, effects,
        tag("button", { id: "render-other", onclick: attempt(() => {
          const query = { pipeline: pipelines.value };
          if (effects.value !== "(same)") query.effects = effects.value;
          return take(query, `${pipelines.value}, effects ${effects.value}`);
        }) }, "Render")),
      tag("p", { id: "against", class: "soft" }, "Nothing is compared yet."),
      tag("table", {}, tag("tbody", { id: "figures" })),
      tag("p", { class: "soft" }, "Difference, ten times as large:"),
      tag("div", { class: "view" }, tag("img", { id: "difference", alt: "difference" })),
      tag("button", { id: "end-compare", onclick: () => { $("other").hidden = $("bar").hidden = true; } }, "End"));
    const bar = $("bar");
    bar.addEventListener("pointerdown", (event) => { bar.setPointerCapture(event.pointerId); event.stopPropagation(); });
    bar.addEventListener("pointermove", (event) => {
      if (!event.buttons) return;
      event.stopPropagation();
      const area = $("stage").getBoundingClientRect();
      part = Math.min(Math.max((event.clientX - area.left) / area.width, 0), 1);
      place();
    });
  },
  refresh(content) {
    fillSelect($("other-pipeline"), content.pipelines, content.pipeline);
    clearTimeout(timer); // the figures follow when the picture has settled a little
    if (!$("other").hidden && !state.glance.coarse) timer = setTimeout(() => figures().catch(() => {}), 700);
  },
};
