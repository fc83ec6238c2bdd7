"use strict";
// Two cursors of the explorer: their place in time, and what the curves do from one to the other.
function explorerCursors({ root, make, number, shade, changed }) {
  const marks = [null, null], names = ["A", "B"];
  let next = null;
  const nearest = (time, at) => {
    let found = 0;
    for (let k = 1; k < time.length; k++) if (Math.abs(time[k] - at) < Math.abs(time[found] - at)) found = k;
    return found;
  };
  // The first click sets A, the second B; each further one moves the nearer of the two.
  function place(at, which = null) {
    let mark = which ?? next ?? marks.indexOf(null);
    if (mark < 0) mark = Math.abs(marks[0] - at) <= Math.abs(marks[1] - at) ? 0 : 1;
    marks[mark] = at;
    next = null;
    changed();
  }
  function clear() { marks.fill(null); next = null; changed(); }

  // Of one curve: its values at the cursors, their difference and slope, and mean and rms of all points from one to the other.
  function between(time, values) {
    const [a, b] = marks.map((mark) => (mark == null ? null : nearest(time, mark)));
    const at = (k) => (k == null ? null : values[k]);
    const found = { a: at(a), b: at(b), difference: null, slope: null, mean: null, rms: null };
    if (a == null || b == null) return found;
    if (found.a != null && found.b != null) {
      found.difference = found.b - found.a;
      if (Math.abs(found.difference) < 1e-12 * Math.abs(found.a)) found.difference = 0;  // what rounding does
      if (a !== b) found.slope = found.difference / (time[b] - time[a]);
    }
    const some = values.slice(Math.min(a, b), Math.max(a, b) + 1).filter((value) => value != null);
    if (some.length) {
      found.mean = some.reduce((sum, value) => sum + value, 0) / some.length;
      found.rms = Math.sqrt(some.reduce((sum, value) => sum + value * value, 0) / some.length);
    }
    return found;
  }
  function draw(u) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.lineWidth = devicePixelRatio;
    marks.forEach((mark, k) => {
      if (mark == null) return;
      const at = Math.round(u.valToPos(u.data[0][nearest(u.data[0], mark)], "x", true));
      if (at < bbox.left || at > bbox.left + bbox.width) return;
      ctx.strokeStyle = ctx.fillStyle = shade("--ink");
      ctx.setLineDash([]);
      ctx.beginPath();
      ctx.moveTo(at, bbox.top);
      ctx.lineTo(at, bbox.top + bbox.height);
      ctx.stroke();
      ctx.textAlign = "left";
      ctx.fillText(names[k], at + 3 * devicePixelRatio, bbox.top + 11 * devicePixelRatio);
    });
    ctx.restore();
  }
  // A table below a plot: a row for each curve that is shown.
  function table(into, u, curves) {
    into.replaceChildren();
    into.hidden = marks.every((mark) => mark == null);
    if (into.hidden) return;
    const whole = make("table", into), top = make("tr", make("thead", whole));
    const times = marks.map((mark) => (mark == null ? "" : ` ${number(u.data[0][nearest(u.data[0], mark)])} s`));
    for (const name of ["", `A${times[0]}`, `B${times[1]}`, "B − A", "per s", "mean", "rms"]) make("th", top, { scope: "col" }, name);
    const body = make("tbody", whole);
    for (const { name, values } of curves.filter((one) => one.values.some((value) => value != null))) {
      const row = make("tr", body), found = between(u.data[0], values);
      make("th", row, { scope: "row" }, name);
      for (const key of ["a", "b", "difference", "slope", "mean", "rms"])
        make("td", row, { "data-of": key, ...(found[key] == null ? {} : { "data-value": found[key] }) }, number(found[key]));
    }
  }
  function controls(bar) {
    const group = make("span", bar, { class: "group", "aria-label": "cursors" });
    names.forEach((name, k) => make("button", group, { type: "button", "data-cursor": name, "aria-label": `place cursor ${name} by the next click` }, name)
      .addEventListener("click", () => { next = k; changed(); }));
    make("button", group, { type: "button", "data-cursor": "none", "aria-label": "no cursors" }, "×").addEventListener("click", clear);
  }
  function listen(u) {
    let down = null;
    u.over.addEventListener("mousedown", (event) => { down = event.clientX; });
    u.over.addEventListener("click", (event) => {
      const at = u.posToVal(event.clientX - u.over.getBoundingClientRect().left, "x");
      if (down != null && Math.abs(event.clientX - down) < 4 && event.detail < 2) place(u.data[0][nearest(u.data[0], at)]);
    });
  }
  function press() {
    for (const button of root.querySelectorAll("[data-cursor]"))
      if (button.dataset.cursor !== "none") button.classList.toggle("placing", names.indexOf(button.dataset.cursor) === next);
  }
  return { marks, place, clear, draw, table, controls, listen, press };
}
