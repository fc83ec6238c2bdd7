"use strict";
// The explorer of a page: tests, channels, models; what is shown stands in the address behind #test=.
(async () => {
  const root = document.getElementById("explorer");
  const head = JSON.parse(document.getElementById("explorer-head").textContent);
  const shades = ["--red", "--blue", "--green", "--purple", "--orange", "--teal"];
  const state = { test: 0, off: new Set(head.hidden), channels: null, zoom: null, by: null, sort: null };
  const REPETITIONS = "repetitions", OBSERVED = head.observed, REFERENCE = "reference";
  const modelled = head.models.filter((name) => name !== REFERENCE);
  const toggles = [OBSERVED, REPETITIONS, ...head.models];
  const shade = (name) => getComputedStyle(root).getPropertyValue(name).trim();
  const colour = (model) => () => shade(shades[model % shades.length]);
  const make = (kind, into, set = {}, text = "") => {
    const one = document.createElement(kind);
    for (const [name, value] of Object.entries(set)) one.setAttribute(name, value);
    if (text) one.textContent = text;
    into.append(one);
    return one;
  };
  const number = (value) => (value == null ? "" : Math.abs(value) >= 1e5 || (value && Math.abs(value) < 1e-3)
    ? value.toExponential(2) : String(+value.toPrecision(4)));

  const cursors = explorerCursors({ root, make, number, shade, changed: () => { marked(); address(); } });

  const reading = (value, unit) => `${number(+value.toPrecision(3))} ${unit}`;

  async function unpack(text) {
    const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new DataView(await new Response(stream).arrayBuffer());
    return { at: (place) => bytes.getUint16(2 * place, true) };
  }
  const points = await unpack(document.getElementById("explorer-points").textContent);

  const cache = new Map();
  function values(number, channel, model) {
    const key = `${number}/${channel}/${model}`;
    if (!cache.has(key)) {
      const test = head.tests[number];
      const curve = test.curves.find((one) => one.channel === channel && one.model === model);
      const found = curve && [];
      for (let k = 0, sum = 0; curve && k < test.points; k++) {
        sum = (sum + points.at(curve.at + k)) & 0xffff;
        found.push(sum ? curve.low + (sum - 1) * curve.per : null);
      }
      if (cache.size > 400) cache.clear();
      cache.set(key, found);
    }
    return cache.get(key);
  }
  const times = (test) => Array.from({ length: test.points }, (_, k) => test.start + k * test.step);
  // A repetition may have begun at another moment: its points are moved by whole steps onto the shown test's.
  function moved(found, from, onto) {
    const shift = Math.round((onto.start - from.start) / onto.step);
    return Array.from({ length: onto.points }, (_, k) => (found && found[k + shift] !== undefined ? found[k + shift] : null));
  }

  const siblings = new Map();
  head.tests.forEach((test, k) => siblings.set(test.condition, [...(siblings.get(test.condition) || []), k]));
  const most = Math.max(...[...siblings.values()].map((all) => all.length)) - 1;
  const withModel = new Set(head.tests.flatMap((test) => test.curves.filter((one) => one.model >= 0).map((one) => one.channel)));
  const names = head.channels.map((one) => one.name);
  const compared = names.filter((name) => withModel.has(name));
  state.channels = new Set([...new Set([...compared, ...names])].slice(0, Math.max(compared.length, 3)));
  state.by = compared[0] || null;

  // Data of one channel of the test that is shown: times, other repetitions, measured, models; and what each model leaves.
  function data(channel) {
    const test = head.tests[state.test];
    const none = Array(test.points).fill(null);
    const others = siblings.get(test.condition).filter((one) => one !== state.test);
    const grey = Array.from({ length: most }, (_, k) =>
      k < others.length ? moved(values(others[k], channel, -1), head.tests[others[k]], test) : none);
    const seen = values(state.test, channel, -1) || none;
    const models = head.models.map((_, model) => values(state.test, channel, model) || none);
    const left = models.map((one) => one.map((value, k) => (value == null || seen[k] == null ? null : value - seen[k])));
    const time = times(test);
    return { whole: [time, ...grey, seen, ...models], left: [time, ...left] };
  }

  const list = root.querySelector(".list"), area = root.querySelector(".plots"), bar = root.querySelector(".bar");
  let plots = [];
  const size = () => Math.max(area.clientWidth, 200);
  const axes = [0, 1].map((side) => ({
    ...(side ? { values: (u, ticks) => ticks.map(number) } : { values: (u, ticks) => ticks.map((value) => `${number(value)} s`) }),
    stroke: () => shade("--soft"), grid: { stroke: () => shade("--grid"), width: 1 }, ticks: { stroke: () => shade("--grid"), width: 1 },
    size: side ? 56 : 28, ...(side ? { space: 16 } : {}), font: "11px system-ui, sans-serif",
  }));

  function plot(kind, channel, series, height, floor) {
    const holder = make("div", area);
    const title = make("div", holder, { class: "title" });
    const unit = channel.unit ? ` (${channel.unit})` : "";
    make("b", title, {}, kind === "left" ? `${channel.label}: ${modelled.length ? "model" : REFERENCE} − ${OBSERVED}${unit}` : `${channel.label}${unit}`);
    const told = make("span", title, { class: "values" });
    const lines = (u) => {
      if (kind !== "left") return;
      const { ctx, bbox } = u;
      ctx.save();
      ctx.strokeStyle = shade("--soft");
      ctx.lineWidth = devicePixelRatio;
      for (const level of floor ? [0, floor, -floor] : [0]) {
        const at = u.valToPos(level, "y", true);
        ctx.setLineDash(level ? [6, 4] : []);
        ctx.beginPath();
        if (at >= bbox.top && at <= bbox.top + bbox.height) { ctx.moveTo(bbox.left, at); ctx.lineTo(bbox.left + bbox.width, at); }
        ctx.stroke();
      }
      ctx.restore();
    };
    const tell = (u) => {
      const at = u.cursor.idx;
      told.textContent = at == null || u.cursor.left < 0 ? "" : [`${number(u.data[0][at])} s`, ...series.flatMap((one, k) =>
        (one.told && u.series[k + 1].show && u.data[k + 1][at] != null ? [`${one.told} ${number(u.data[k + 1][at])}`] : []))].join("  ");
    };
    const made = new uPlot({
      width: size(), height, legend: { show: false }, scales: { x: { time: false } }, axes,
      cursor: { sync: { key: "explorer" }, drag: { x: true, y: false, setScale: false }, points: { size: 5 },
        bind: { dblclick: () => () => { zoom(null); return null; } } },
      series: [{}, ...series], hooks: { draw: [lines, cursors.draw], setCursor: [tell], setSelect: [selected] },
    }, kind === "left" ? data(channel.name).left : data(channel.name).whole, holder);
    made.of = { kind, channel: channel.name, holder, told: series.map((one) => one.told), between: make("div", holder, { class: "between" }) };
    cursors.listen(made);
    plots.push(made);
  }
  function marked() {
    for (const one of plots) {
      const curves = one.of.told.flatMap((name, k) => (name && one.series[k + 1].show ? [{ name, values: one.data[k + 1] }] : []));
      cursors.table(one.of.between, one, curves);
      one.redraw(false);
    }
    cursors.press();
  }

  function build() {
    for (const one of plots) one.destroy();
    plots = [];
    area.replaceChildren();
    head.channels.filter((one) => state.channels.has(one.name)).forEach((channel) => {
      const grey = Array.from({ length: most }, () => ({ stroke: () => shade("--grey"), width: 1, points: { show: false } }));
      const seen = { stroke: () => shade("--ink"), width: 1.6, told: OBSERVED, points: { show: false } };
      const models = head.models.map((name, k) => ({
        stroke: colour(k), width: 1.2, told: name, points: { show: false }, dash: k < shades.length ? undefined : [6, 3] }));
      plot("whole", channel, [...grey, seen, ...models], 190);
      if (withModel.has(channel.name)) plot("left", channel, models, 110, head.floors[channel.name]);
    });
    switched();
    zoom(state.zoom);
  }

  function selected(u) {
    if (u.select.width < 4) return;
    const [from, to] = [u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")];
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    zoom([from, to]);
  }
  function zoom(part) {
    const test = head.tests[state.test];
    state.zoom = part;
    const [min, max] = part || [test.start, test.start + (test.points - 1) * test.step];
    for (const one of plots) one.setScale("x", { min, max });
    address();
  }
  function stretch(factor) {
    const test = head.tests[state.test];
    const [min, max] = state.zoom || [test.start, test.start + (test.points - 1) * test.step];
    const middle = (min + max) / 2, half = ((max - min) / 2) * factor;
    const end = test.start + (test.points - 1) * test.step;
    const next = [Math.max(middle - half, test.start), Math.min(middle + half, end)];
    zoom(next[0] <= test.start && next[1] >= end ? null : next);
  }

  function show(test, keep = true) {
    state.test = test;
    if (!keep) state.zoom = null;
    for (const one of plots) one.setData(data(one.of.channel)[one.of.kind], true);
    for (const one of plots) {
      const empty = one.of.kind === "left" && one.data.slice(1).every((all) => all.every((value) => value == null));
      one.of.holder.hidden = empty;
    }
    root.querySelector(".now").textContent = head.tests[test].label;
    for (const row of list.querySelectorAll("tbody tr")) {
      const here = +row.dataset.test === test;
      row.setAttribute("aria-selected", here);
      if (here) inView(row);
    }
    marked();
    zoom(state.zoom);
  }
  function inView(row) {
    // Within the list alone: the page itself must not jump.
    const top = row.offsetTop - list.querySelector("thead").offsetHeight;
    if (top < list.scrollTop || row.offsetTop + row.offsetHeight > list.scrollTop + list.clientHeight) list.scrollTop = top - 40;
  }
  function switched() {
    for (const one of plots) {
      const models = one.of.kind === "left" ? 1 : most + 2;
      for (let k = 1; k < one.series.length; k++) {
        const name = k >= models ? head.models[k - models] : k === most + 1 ? OBSERVED : REPETITIONS;
        if (one.series[k].show === state.off.has(name)) one.setSeries(k, { show: !state.off.has(name) });
      }
    }
    for (const button of bar.querySelectorAll("[data-of]")) button.setAttribute("aria-pressed", !state.off.has(button.dataset.of));
    for (const button of bar.querySelectorAll("[data-channel]")) button.setAttribute("aria-pressed", state.channels.has(button.dataset.channel));
    marked();
    address();
  }
  function toggle(name) {
    state.off.has(name) ? state.off.delete(name) : state.off.add(name);
    table();
    switched();
  }

  function order() {
    const order = head.tests.map((_, k) => k);
    const { sort } = state;
    if (!sort) return order;
    const value = (k) => (sort.column < 0 ? head.tests[k].name : head.tests[k].rms[sort.column][state.by]);
    return order.sort((a, b) => {
      const [one, two] = [value(a), value(b)];
      if (one == null || two == null) return (one == null) - (two == null);
      return sort.way * (sort.column < 0 ? one.localeCompare(two, undefined, { numeric: true }) : one - two);
    });
  }
  function table() {
    const wanted = (list.querySelector(".filter") || { value: "" }).value;
    list.replaceChildren();
    const filter = make("input", list, { class: "filter", type: "search", placeholder: "filter tests", "aria-label": "filter tests" });
    filter.value = wanted;
    filter.addEventListener("input", () => rows(body, filter.value));
    const whole = make("table", list), top = make("tr", make("thead", whole));
    const channel = head.channels.find((one) => one.name === state.by);
    ["test", ...(channel ? head.models : [])].forEach((name, k) => {
      if (state.off.has(name)) return;
      const now = state.sort && state.sort.column === k - 1;
      const cell = make("th", top, { scope: "col", tabindex: 0, "aria-sort": now ? (state.sort.way > 0 ? "ascending" : "descending") : "none" },
        (name === REFERENCE ? "rms error" : name) + (now ? (state.sort.way > 0 ? " ↑" : " ↓") : ""));
      const sort = () => { state.sort = { column: k - 1, way: now ? -state.sort.way : k ? -1 : 1 }; table(); };
      cell.addEventListener("click", sort);
      cell.addEventListener("keydown", (event) => { if (event.key === "Enter") sort(); });
    });
    const body = make("tbody", whole);
    rows(body, wanted);
  }
  function rows(body, wanted) {
    body.replaceChildren();
    const highest = Math.max(...head.tests.flatMap((test) => test.rms.map((one) => one[state.by] || 0)));
    const unit = (head.channels.find((one) => one.name === state.by) || {}).unit || "";
    for (const k of order()) {
      const test = head.tests[k];
      if (!`${test.name} ${test.label}`.toLowerCase().includes(wanted.toLowerCase())) continue;
      const row = make("tr", body, { tabindex: 0, "data-test": k, "aria-selected": k === state.test });
      make("td", row, {}, test.label);
      if (state.by) test.rms.forEach((one, model) => {
        if (state.off.has(head.models[model])) return;
        const cell = make("td", row, {}, one[state.by] == null ? "" : reading(one[state.by], unit));
        const width = highest ? (100 * (one[state.by] || 0)) / highest : 0;
        make("span", cell, { class: "meter", style: `width:${width}%;background:var(${shades[model % shades.length]})` });
      });
      row.addEventListener("click", () => show(k));
      row.addEventListener("keydown", (event) => { if (event.key === "Enter") show(k); });
    }
  }

  function controls() {
    const walk = make("span", bar, { class: "group" });
    make("button", walk, { type: "button", "aria-label": "test before" }, "←").addEventListener("click", () => step(-1));
    make("b", walk, { class: "now" });
    make("button", walk, { type: "button", "aria-label": "next test" }, "→").addEventListener("click", () => step(1));
    const near = make("span", bar, { class: "group" });
    for (const [text, said, act] of [["+", "zoom in", () => stretch(0.5)], ["−", "zoom out", () => stretch(2)], ["whole test", "whole test", () => zoom(null)]])
      make("button", near, { type: "button", "aria-label": said }, text).addEventListener("click", act);
    cursors.controls(bar);
    const lines = make("span", bar, { class: "group", "aria-label": "curves" });
    toggles.filter((name) => name !== REPETITIONS || most > 0).forEach((name) => {
      const button = make("button", lines, { type: "button", "data-of": name });
      const model = head.models.indexOf(name);
      const of = model >= 0 ? shades[model % shades.length] : name === OBSERVED ? "--ink" : "--grey";
      make("span", button, { class: "swatch", style: `background:var(${of})` });
      button.append(name);
      button.addEventListener("click", () => toggle(name));
    });
    if (names.length > 1) {
      const channels = make("span", bar, { class: "group", "aria-label": "channels" });
      for (const one of head.channels) make("button", channels, { type: "button", "data-channel": one.name }, one.label)
        .addEventListener("click", () => { state.channels.has(one.name) ? state.channels.delete(one.name) : state.channels.add(one.name); state.picked = true; build(); });
    }
    if (compared.length > 1) {
      const by = make("select", make("label", bar, { class: "group" }, "table of "), { "aria-label": "channel of the table" });
      for (const name of compared) make("option", by, { value: name }, head.channels.find((one) => one.name === name).label);
      by.value = state.by;
      by.addEventListener("change", () => { state.by = by.value; table(); });
    }
  }
  function step(by) {
    const shown = [...list.querySelectorAll("tbody tr")].map((row) => +row.dataset.test);
    const here = shown.indexOf(state.test);
    if (shown.length) show(shown[(here + by + shown.length) % shown.length]);
  }

  function mark(which) {
    const here = plots.find((one) => one.cursor.left >= 0 && one.cursor.idx != null);
    if (here) cursors.place(here.data[0][here.cursor.idx], which);
  }

  // The address: #test=NAME&from=S&to=S&a=S&b=S&off=A,B&channels=A,B
  let written = "";
  function address() {
    if (!started) return;
    const parts = new URLSearchParams({ test: head.tests[state.test].name });
    if (state.zoom) { parts.set("from", number(state.zoom[0])); parts.set("to", number(state.zoom[1])); }
    cursors.marks.forEach((mark, k) => { if (mark != null) parts.set("ab"[k], String(+mark.toPrecision(9))); });
    if (state.off.size || head.hidden.length) parts.set("off", [...state.off].join("|"));
    if (state.picked) parts.set("channels", [...state.channels].join("|"));
    written = `#${parts}`;
    history.replaceState(null, "", written);
  }
  function follow() {
    if (!location.hash.startsWith("#test=") || location.hash === written) return false;
    const parts = new URLSearchParams(location.hash.slice(1));
    const test = head.tests.findIndex((one) => one.name === parts.get("test"));
    const split = (name) => (parts.get(name) || "").split("|").filter(Boolean);
    if (test < 0) return false;
    const from = parseFloat(parts.get("from")), to = parseFloat(parts.get("to"));
    state.zoom = from < to ? [from, to] : null;
    [..."ab"].forEach((name, k) => { cursors.marks[k] = Number.isFinite(parseFloat(parts.get(name))) ? parseFloat(parts.get(name)) : null; });
    if (parts.has("off")) state.off = new Set(split("off").filter((name) => toggles.includes(name)));
    const channels = split("channels").filter((name) => names.includes(name));
    if (channels.length) [state.channels, state.picked] = [new Set(channels), true];
    state.test = test;
    return true;
  }

  let started = false;
  controls();
  const led = follow();
  table();
  build();
  show(state.test);
  started = true;
  if (led) { address(); root.scrollIntoView(); }
  addEventListener("hashchange", () => { if (follow()) { table(); build(); show(state.test); root.scrollIntoView(); } });
  addEventListener("keydown", (event) => {
    if (/^(input|select|textarea)$/i.test(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
    const acts = { ArrowRight: () => step(1), ArrowLeft: () => step(-1), "+": () => stretch(0.5), "-": () => stretch(2), 0: () => zoom(null),
      a: () => mark(0), b: () => mark(1), Escape: () => cursors.clear(), m: () => toggle(OBSERVED), r: () => toggle(REPETITIONS) };
    head.models.slice(0, 9).forEach((name, k) => { acts[k + 1] = () => toggle(name); });
    if (acts[event.key]) { acts[event.key](); event.preventDefault(); }
  });
  new ResizeObserver(() => { for (const one of plots) if (one.width !== size()) one.setSize({ width: size(), height: one.height }); }).observe(area);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { for (const one of plots) one.redraw(false); });
  root.dataset.ready = "yes";
})();
