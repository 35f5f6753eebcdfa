// Findings, measurements, and what can be taken away.
import { fetchOrNote, send } from "./connection.js";
import { $, tag } from "./dom.js";

export function diagnostics(content) {
  const listed = content.diagnostics.map((d) => tag("div", { class: "finding", "data-rule": d.rule },
    tag("b", { class: d.severity }, `${d.severity} ${d.rule} `), d.message, tag("small", {}, d.place),
    ...(d.source.length ? [tag("pre", {}, d.source.join("\n"))] : [])));
  const again = content.rendering ? [] : [tag("div", { class: "row" },
    tag("button", { id: "retry", onclick: () => send({ do: "retry" }) }, "Try again"))];
  $("diagnostics").replaceChildren(...again, ...(listed.length ? listed : [tag("p", { class: "soft" }, "Nothing to report.")]));
  const button = $("tabs").querySelector("[data-tab=diagnostics]");
  const errors = content.diagnostics.filter((d) => d.severity === "error").length;
  button.replaceChildren("diagnostics", ...(errors ? [" ", tag("span", { class: "count" }, errors)] : []));
}

export function cost() {
  const said = tag("pre", { hidden: true });
  const frame = tag("iframe", { title: "accuracy against time", hidden: true });
  const button = tag("button", { id: "measure" }, "Measure");
  const look = async () => {
    const now = await (await fetchOrNote("cost")).json();
    said.textContent = now.said.join("\n");
    said.hidden = now.state === "done" || !now.said.length;
    button.disabled = now.state === "running";
    if (now.state === "running") setTimeout(() => look().catch(() => {}), 1000);
    if (now.state === "done") {
      frame.hidden = false;
      frame.src = "cost.html";
    }
  };
  button.onclick = async () => {
    await fetchOrNote("cost", { method: "POST" });
    await look();
  };
  $("cost").append(tag("p", { class: "soft" },
    "What samples, depth and mask cost, and what they bring: nau-cost on the files as they are saved. Takes minutes."),
  button, said, frame);
}

let camera = "";
export function exports_(content) {
  if (!$("frames")) {
    const first = tag("input", { type: "number", min: 0, value: 0, "aria-label": "first frame" });
    const last = tag("input", { type: "number", min: 0, value: 10, "aria-label": "last frame" });
    const link = (name) => tag("a", { href: `export/${name}`, download: name }, name);
    const zip = tag("button", { id: "frames", onclick: async () => {
      const query = new URLSearchParams({ first: first.value, last: last.value });
      const answer = await fetchOrNote(`export/frames.zip?${query}`).catch(() => null);
      if (!answer) return;
      tag("a", { href: URL.createObjectURL(await answer.blob()), download: "frames.zip" }).click();
    } }, "frames.zip");
    $("export").append(
      tag("div", { class: "row" }, "Picture: ", link("picture.png"), link("picture.exr")),
      tag("div", { class: "row" }, "Frames ", first, " to ", last, zip),
      tag("p", {}, "The view, to be pasted into a project:"), tag("pre", { id: "camera" }));
  }
  const pose = JSON.stringify(content.pose);
  if (pose !== camera && content.pose.length) {
    camera = pose;
    fetch("export/camera.txt").then(async (a) => { if (a.ok) $("camera").textContent = await a.text(); });
  }
}
