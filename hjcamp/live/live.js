"use strict";
// The page of a run in hand: events of its server become curves, limits and counts.
(() => {
  const byId = (id) => document.getElementById(id);
  const shades = ["--blue", "--red", "--green", "--purple", "--orange", "--teal"];
  const shade = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();
  const NEAR = 0.1, HEIGHT = 170;
  let run = {}, test = null, rows = [], first = -1, plots = [], waiting = false, ended = false;

  const make = (kind, into, set = {}, text = "") => {
    const one = document.createElement(kind);
    for (const [name, value] of Object.entries(set)) one.setAttribute(name, value);
    if (text) one.textContent = text;
    into.append(one);
    return one;
  };
  const number = (value) => {
    if (value == null) return "–";
    const size = Math.abs(value);
    if (size && (size >= 1e5 || size < 1e-4)) return value.toExponential(2);
    return value.toFixed(size >= 1000 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : 3);
  };
  const span = (seconds) => (seconds >= 3600 ? `${(seconds / 3600).toFixed(1)} h` : seconds >= 90
    ? `${Math.round(seconds / 60)} min` : `${Math.round(seconds)} s`);

  function showRun() {
    document.title = `${run.done}/${run.total} ${run.name || ""}`;
    byId("name").textContent = run.name || "hjcamp run";
    const state = byId("state");
    state.textContent = state.className = run.state || "starting";
    state.classList.add("pill");
    const made = run.done + run.failed, here = made - (run.here || 0), left = run.total - made;
    const spent = Date.now() / 1000 - run.began;
    if (!run.name) return;
    const facts = [`${run.done} of ${run.total} tests done`];
    if (run.failed) facts.push(`${run.failed} failed`);
    if (run.state === "running" && here > 1 && left > 0) facts.push(`about ${span((spent / here) * left)} left`);
    facts.push(`backend ${run.backend}`, run.folder);
    byId("facts").textContent = facts.join(" · ");
    const [done, failed] = byId("progress").children;
    done.style.width = `${(100 * run.done) / (run.total || 1)}%`;
    failed.style.width = `${(100 * run.failed) / (run.total || 1)}%`;
    byId("progress").setAttribute("aria-valuenow", Math.round((100 * made) / (run.total || 1)));
    const words = byId("words");
    words.textContent = run.words || run.message || "";
    words.hidden = !words.textContent;
    byId("stop").hidden = ended || run.state !== "running";
    showConditions();
  }
  function showConditions() {
    const body = byId("conditions").querySelector("tbody");
    body.replaceChildren();
    for (const [name, one] of Object.entries(run.conditions || {})) {
      const row = make("tr", body, test && test.condition === name ? { class: "inhand" } : {});
      make("td", row, {}, one.label || name);
      make("td", row, one.failed ? { class: "far" } : {}, `${one.done}/${one.total}${one.failed ? `, ${one.failed} failed` : ""}`);
      make("td", row, {}, one.error ? `${number(one.error[0])} ${one.error[1]}` : "");
    }
  }

  const axes = (unit) => [{ label: "time (s)", size: 34 }, { label: unit, size: 60 }].map((given) => ({
    ...given, stroke: () => shade("--soft"), grid: { stroke: () => shade("--grid"), width: 1 }, ticks: { stroke: () => shade("--grid"), width: 1 },
    font: "11px system-ui, sans-serif", labelFont: "11px system-ui, sans-serif", labelSize: 16 }));
  function build() {
    for (const one of plots) one.plot.destroy();
    const area = byId("plots");
    area.replaceChildren();
    plots = [];
    const panels = new Map();
    for (const [place, channel] of test.channels.entries()) {
      if (!panels.has(channel.panel)) panels.set(channel.panel, []);
      panels.get(channel.panel).push({ ...channel, place: place + 1 });
    }
    for (const channels of panels.values()) {
      let next = 0;
      const legend = make("div", area, { class: "legend" });
      const series = channels.map((one) => {
        const colour = one.wanted ? "--ink" : shades[next++ % shades.length];
        const told = make("span", legend);
        make("span", told, { class: one.wanted ? "swatch dashed" : "swatch", style: `color: var(${colour})` });
        told.append(`${one.label} `);
        return { colour, value: make("b", told), unit: one.unit, place: one.place, told,
          set: { stroke: () => shade(colour), width: 1.4, dash: one.wanted ? [6, 4] : undefined, points: { show: false } } };
      });
      const holder = make("div", area);
      const plot = new uPlot({
        width: Math.max(holder.clientWidth, 200), height: HEIGHT, legend: { show: false }, scales: { x: { time: false } }, axes: axes(channels[0].unit),
        cursor: { sync: { key: "live" }, drag: { x: true, y: false } }, series: [{}, ...series.map((one) => one.set)],
      }, [[], ...series.map(() => [])], holder);
      plots.push({ plot, series, holder, legend });
    }
  }
  function draw() {
    waiting = false;
    if (!test) return;
    const start = first >= 0 ? first : 0;
    const time = rows.map((row) => (row[0] - start) * test.period);
    const last = rows[rows.length - 1] || [];
    for (const { plot, series, holder, legend } of plots) {
      const there = series.map((one) => rows.some((row) => row[one.place] != null));
      legend.hidden = holder.hidden = !there.some(Boolean);
      series.forEach((one, k) => {
        one.told.hidden = !there[k];
        one.value.textContent = `${number(last[one.place])} ${one.unit}`;
      });
      if (plot.width !== holder.clientWidth && holder.clientWidth) plot.setSize({ width: holder.clientWidth, height: HEIGHT });
      plot.setData([time, ...series.map((one) => rows.map((row) => row[one.place]))]);
    }
  }
  const soon = () => { if (!waiting) { waiting = true; requestAnimationFrame(draw); } };

  function showLimits(limits) {
    const area = byId("limits");
    byId("nolimits").hidden = limits.length > 0;
    byId("nolimits").textContent = "This plant and rig declare none.";
    if (area.childElementCount !== limits.length) {
      area.replaceChildren();
      limits.forEach((_, k) => {
        const box = make("div", area, { class: "limit" });
        for (const name of ["name", "margin", "track"]) make(name === "track" ? "div" : "span", box, { class: name });
        make("div", box.lastChild, { class: "seen" });
        make("div", box.lastChild, { class: "at" });
        box.firstChild.textContent = test.watches[k].label;
      });
    }
    limits.forEach((one, k) => {
      const told = test.watches[k], box = area.children[k];
      const low = told.low ?? Math.min(0, one.lowest ?? 0), high = told.high ?? Math.max(1.2 * (one.highest ?? 0), 2 * low, low + 1);
      const place = (value) => `${Math.min(100, Math.max(0, (100 * (value - low)) / (high - low)))}%`;
      const [seen, at] = box.querySelector(".track").children;
      const none = one.lowest == null;
      seen.hidden = none;
      at.hidden = one.value == null;
      if (!none) {
        seen.style.left = place(one.lowest);
        seen.style.right = `calc(100% - ${place(one.highest)})`;
      }
      if (one.value != null) at.style.left = place(one.value);
      const full = told.low != null && told.high != null ? (high - low) / 2 : Math.abs(told.low ?? told.high);
      box.className = `limit${one.margin == null ? "" : one.margin < 0 ? " past" : one.margin < NEAR * full ? " near" : ""}`;
      const ends = [told.low, told.high].map((end) => (end == null ? "" : String(+end.toPrecision(6))));
      const allowed = told.low != null && told.low === -told.high ? `±${ends[1]}` : told.low == null ? `≤ ${ends[1]}` : told.high == null ? `≥ ${ends[0]}` : `${ends[0]} to ${ends[1]}`;
      box.children[0].title = `allowed: ${allowed} ${told.unit}`;
      box.children[1].textContent = none ? `${allowed} ${told.unit}` : `${number(Math.abs(one.value) < 1e-9 * full ? 0 : one.value)} of ${allowed} ${told.unit}, closest ${number(one.margin)}`;
    });
  }

  const on = {
    run: (news) => { run = news; ended = ended || news.ended; showRun(); },
    test: (news) => {
      if (!news.id) return;
      const same = test && JSON.stringify([test.channels, test.watches]) === JSON.stringify([news.channels, news.watches]);
      test = news; rows = []; first = -1;
      byId("test").textContent = news.label;
      if (!same) { build(); byId("limits").replaceChildren(); }
      showConditions();
    },
    rows: (news) => {
      if (!test) return;
      rows.push(...news.rows);
      first = news.first;
      const phase = byId("phase");
      phase.hidden = news.phase == null;
      phase.textContent = test.phases[String(news.phase)] || `phase ${news.phase}`;
      byId("clock").textContent = `${((news.samples - (first >= 0 ? first : 0)) * test.period).toFixed(2)} s`;
      showLimits(news.limits);
      soon();
    },
  };
  const source = new EventSource("events");
  source.onmessage = (event) => {
    const news = JSON.parse(event.data);
    on[news.kind](news);
    if (ended && news.kind === "run") {
      byId("state").classList.remove("running");
      // what was shown stays; asked again, nobody would answer
      setTimeout(() => source.close(), 300);
    }
  };
  source.onopen = () => { if (run.name) showRun(); };
  source.onerror = () => {
    if (ended) { source.close(); return; }
    const state = byId("state");
    state.textContent = "the run does not answer";
    state.className = "pill lost";
  };
  addEventListener("resize", soon);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plots.forEach(({ plot }) => plot.redraw()));
})();
