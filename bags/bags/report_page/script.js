"use strict";
// Every text of the recording is put in by textContent or drawn: what people said is never read as HTML.
const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const bytes = (text) => Uint8Array.from(atob(text), (char) => char.charCodeAt(0));
const numbers = (text) => new Uint32Array(bytes(text).buffer); // little-endian, as every browser's machine is
const make = (tag, parent, text = "", kind = "") => {
  const node = Object.assign(document.createElement(tag), { textContent: text, className: kind });
  parent.append(node);
  return node;
};
const seconds = (t) => `${Math.max(0, t).toFixed(1)} s`;
const number = (value, digits = 3) => (value === null ? "–" : value.toFixed(digits));
const percent = (value) => (value === null ? "–" : `${(100 * value).toFixed(1)} %`);
// The last of `rows`, which are in order, that had begun at time t; -1 where none had.
const latest = (rows, t) => {
  let low = 0, high = rows.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (rows[middle].t_s <= t + 1e-6) low = middle + 1; else high = middle;
  }
  return low - 1;
};
const color = (scale, part) => scale[Math.min(scale.length - 1, Math.max(0, Math.floor(part * scale.length)))];

const paint = data.palette;
const end = Math.max(data.end_s, ...data.decisions.map((row) => row.t_s), 0.001);
const stops = [...new Set([0, ...data.decisions.map((row) => Math.max(0, row.t_s)), end])].sort((a, b) => a - b);
let now = 0, playing = 0, plays = 0;

// --- the map ---
const map = byId("map");
const picture = (kind, content) => Object.assign(new Image(), { src: `data:image/${kind};base64,${content}` });
const floor = data.floor && picture("png", data.floor.png);
const layouts = (data.belief ? data.belief.layouts : []).map((layout) => {
  const sheet = Object.assign(document.createElement("canvas"), { width: layout.columns, height: layout.rows });
  return { ...layout, cells: numbers(layout.cells), places: numbers(layout.places), sheet, frame: -1 };
});
const beliefs = (data.belief ? data.belief.frames : []).map((frame) => ({ ...frame, levels: bytes(frame.levels) }));
const heat = paint.belief.map((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)));
const shown = data.shown_m; // left, right, bottom, top; null where there is nothing to draw

const beliefSheet = (index) => {
  const frame = beliefs[index], layout = layouts[frame.layout];
  if (layout.frame !== index) {
    const pen = layout.sheet.getContext("2d"), image = pen.createImageData(layout.columns, layout.rows);
    layout.cells.forEach((cell, place) => {
      image.data.set([...heat[frame.levels[layout.places[place]]], 255], 4 * cell);
    });
    pen.putImageData(image, 0, 0);
    layout.frame = index;
  }
  return layout;
};
const poseAt = (t) => {
  const index = latest(data.way, t), here = data.way[Math.max(0, index)], next = data.way[index + 1];
  if (!here || !next || index < 0) return here;
  const part = Math.min(1, Math.max(0, (t - here.t_s) / (next.t_s - here.t_s || 1)));
  const turn = Math.atan2(Math.sin(next.yaw_rad - here.yaw_rad), Math.cos(next.yaw_rad - here.yaw_rad));
  const between = (name, change) => here[name] + part * change;
  return { x_m: between("x_m", next.x_m - here.x_m), y_m: between("y_m", next.y_m - here.y_m), yaw_rad: between("yaw_rad", turn) };
};
const drawMap = () => {
  const width = byId("legend").clientWidth, dots = window.devicePixelRatio || 1;
  if (!shown || !width) return;
  const [left, right, bottom, top] = shown;
  const scale = Math.min(width / (right - left), (0.74 * window.innerHeight) / (top - bottom));
  map.style.width = `${scale * (right - left)}px`;
  map.style.height = `${scale * (top - bottom)}px`;
  map.width = Math.round(scale * (right - left) * dots);
  map.height = Math.round(scale * (top - bottom) * dots);
  const pen = map.getContext("2d"), small = scale < 45;
  pen.scale(dots, dots);
  const X = (x) => (x - left) * scale, Y = (y) => (top - y) * scale;
  const sheet = (image, x0, x1, y0, y1) => pen.drawImage(image, X(x0), Y(y1), (x1 - x0) * scale, (y1 - y0) * scale);
  const disc = (x, y, radius, fill, edge) => {
    pen.beginPath(); pen.arc(X(x), Y(y), radius, 0, 2 * Math.PI);
    if (fill) Object.assign(pen, { fillStyle: fill }).fill(); else Object.assign(pen, { strokeStyle: edge }).stroke();
  };
  const cross = (x, y, shade, thick) => {
    pen.lineWidth = thick; pen.strokeStyle = shade;
    pen.stroke(new Path2D(`M${X(x) - 6} ${Y(y) - 6} l12 12 m0 -12 l-12 12`));
  };
  const words = (text, x, y, shade, font) => {
    pen.font = font; pen.textAlign = "center"; pen.textBaseline = "top"; pen.lineJoin = "round";
    pen.strokeStyle = "#ffffffcc"; pen.lineWidth = 3; pen.strokeText(text, x, y);
    pen.fillStyle = shade; pen.fillText(text, x, y);
  };
  pen.fillStyle = paint.unknown; pen.fillRect(0, 0, map.width, map.height);
  pen.imageSmoothingEnabled = false;
  if (floor && floor.complete) sheet(floor, data.floor.left_m, data.floor.right_m, data.floor.bottom_m, data.floor.top_m);
  const believed = beliefs.length ? Math.max(0, latest(beliefs, now)) : -1;
  if (believed >= 0) {
    const layout = beliefSheet(believed);
    sheet(layout.sheet, layout.left_m, layout.left_m + layout.columns * layout.cell_m, layout.bottom_m, layout.bottom_m + layout.rows * layout.cell_m);
  }
  for (const thing of data.things.filter((thing) => !thing.wanted)) {
    disc(thing.x_m, thing.y_m, 2.2, paint.faint);
    if (!small) words(thing.label, X(thing.x_m), Y(thing.y_m) + 4, paint.muted, "10px system-ui, sans-serif");
  }
  drawWay(pen, X, Y);
  for (const mark of data.marks) {
    const age = now - mark.t_s;
    if (age < 0 || (!mark.wanted && age > 3)) continue; // what was not looked for is shown for a moment
    pen.lineWidth = mark.wanted ? 2 : 1.2;
    if (mark.is_false) { cross(mark.x_m, mark.y_m, "#ffffff", 5); cross(mark.x_m, mark.y_m, paint.false_alarm, 2.5); }
    else disc(mark.x_m, mark.y_m, mark.wanted ? 6 : 4, null, mark.wanted ? paint.belief[230] : paint.muted);
  }
  const goal = data.goals[latest(data.goals, now)];
  if (goal) {
    pen.setLineDash([3, 3]); pen.lineWidth = 1.8; disc(goal.x_m, goal.y_m, 9, null, paint.ink); pen.setLineDash([]);
  }
  const robot = poseAt(now);
  if (robot) drawRobot(pen, X, Y, scale, robot);
  for (const thing of data.things.filter((thing) => thing.wanted)) {
    drawStar(pen, X(thing.x_m), Y(thing.y_m), small ? 9 : 12);
    words(thing.label, X(thing.x_m), Y(thing.y_m) + 13, paint.ink, "bold 12px system-ui, sans-serif");
  }
};
const drawWay = (pen, X, Y) => {
  pen.lineCap = pen.lineJoin = "round";
  data.way.slice(1).forEach((place, index) => {
    const past = place.t_s <= now;
    pen.beginPath(); pen.lineWidth = past ? 3 : 1.2;
    pen.strokeStyle = past ? color(paint.time, place.t_s / end) : paint.faint;
    pen.moveTo(X(data.way[index].x_m), Y(data.way[index].y_m)); pen.lineTo(X(place.x_m), Y(place.y_m)); pen.stroke();
  });
};
const drawRobot = (pen, X, Y, scale, pose) => {
  const x = X(pose.x_m), y = Y(pose.y_m), size = Math.max(8, 0.17 * scale);
  if (data.half_view_rad > 0) {
    pen.beginPath(); pen.moveTo(x, y); pen.fillStyle = "#352f8f2b";
    pen.arc(x, y, 1.5 * scale, -pose.yaw_rad - data.half_view_rad, -pose.yaw_rad + data.half_view_rad); pen.fill();
  }
  pen.save(); pen.translate(x, y); pen.rotate(-pose.yaw_rad);
  pen.beginPath(); pen.arc(0, 0, size, 0, 2 * Math.PI); pen.fillStyle = color(paint.time, now / end); pen.fill();
  pen.lineWidth = 1.5; pen.strokeStyle = "#ffffff"; pen.stroke();
  pen.scale(size, size); pen.fillStyle = "#ffffff"; pen.fill(new Path2D("M.75 0 L-.5 .5 L-.25 0 L-.5 -.5 Z")); pen.restore();
};
const drawStar = (pen, x, y, size) => {
  const star = new Path2D("M0-1L.25-.34L.95-.31L.4.13L.59.81L0 .42L-.59.81L-.4.13L-.95-.31L-.25-.34Z");
  pen.save(); pen.translate(x, y); pen.scale(size, size); pen.lineWidth = 1.2 / size;
  pen.fillStyle = paint.target; pen.fill(star); pen.strokeStyle = paint.ink; pen.stroke(star); pen.restore();
};

// --- the camera ---
const pictures = data.frames.map((frame) => picture("jpeg", frame.jpeg));
const lastFrame = data.frames.at(-1);
const nameOf = (frame) => (frame.decision !== null ? `step ${data.decisions[frame.decision].step}` : frame === lastFrame ? "the end" : "");
const drawCamera = () => {
  const index = Math.max(0, latest(data.frames, now)), frame = data.frames[index], sheet = byId("picture");
  if (!frame) return;
  const sharp = 2, pen = sheet.getContext("2d");
  sheet.width = sharp * frame.width; sheet.height = sharp * frame.height;
  if (pictures[index].complete) pen.drawImage(pictures[index], 0, 0, sheet.width, sheet.height);
  const shadeOf = (box) => (box.wanted ? paint.target : "#ffffff"), tags = [];
  for (const box of frame.boxes) {
    pen.lineWidth = box.wanted ? 5 : 2.5; pen.strokeStyle = shadeOf(box);
    pen.strokeRect(box.left * sheet.width, box.top * sheet.height, (box.right - box.left) * sheet.width, (box.bottom - box.top) * sheet.height);
  }
  pen.font = "20px system-ui, sans-serif";
  for (const box of frame.boxes.toReversed()) { // what was looked for keeps its place; a tag over another moves away
    const text = `${box.label} ${box.score.toFixed(2)}`, wide = pen.measureText(text).width + 10;
    const from = Math.max(0, Math.min(box.left * sheet.width, sheet.width - wide)), below = box.bottom * sheet.height, above = box.top * sheet.height - 26;
    const places = [...(box.wanted ? [below, above] : [above, below]), above - 27, below + 27, above - 54, below + 54];
    const free = (high) => high >= 0 && high + 26 <= sheet.height && tags.every((tag) => Math.abs(tag.high - high) >= 26 || from >= tag.from + tag.wide || tag.from >= from + wide);
    const high = places.find(free) ?? (box.wanted ? Math.min(Math.max(0, below), sheet.height - 26) : null);
    if (high === null) continue;
    tags.push({ from, high, wide });
    pen.fillStyle = shadeOf(box); pen.fillRect(from, high, wide, 26);
    pen.fillStyle = paint.ink; pen.fillText(text, from + 5, high + 20);
  }
  byId("caption").textContent = [nameOf(frame), `at ${seconds(frame.t_s)}`].filter(Boolean).join(", ");
};

// --- lists ---
const table = (id, heads, rows) => {
  const head = make("tr", make("thead", byId(id)));
  heads.forEach((name) => { make("th", head, name).scope = "col"; });
  const body = make("tbody", byId(id));
  return rows.map((cells) => {
    const row = make("tr", body);
    cells.forEach((text) => make("td", row, text));
    return row;
  });
};
const facts = (id, rows) => rows.forEach((row) => {
  const pair = make("div", byId(id));
  make("dt", pair, row.name); make("dd", pair, row.text);
});
const link = (node, t) => {
  node.type = "button";
  node.addEventListener("click", () => { pause(); go(t); });
  return node;
};
const lines = data.chat.map((line) => {
  const row = make("li", byId("lines"), "", line.who), button = link(make("button", row), line.t_s);
  make("small", button, `${line.who}, ${seconds(line.t_s)}`); make("br", button); button.append(line.text);
  return row;
});
const decided = data.frames.filter((frame) => !data.decisions.length || nameOf(frame));
const thumbs = decided.map((frame) => {
  const button = link(make("button", byId("strip")), frame.t_s), image = make("img", button);
  image.src = `data:image/jpeg;base64,${frame.jpeg}`; image.alt = ""; make("span", button, nameOf(frame));
  return button;
});
const decisions = data.decisions.map((row) => {
  const details = make("details", byId("decisions")), summary = make("summary", details, `${row.step}  ${row.action} `);
  make("span", summary, `at ${seconds(row.t_s)}: in view ${percent(row.p_in_view)} (ends at ${percent(row.tau)}), entropy ${percent(row.entropy)}`);
  link(summary, row.t_s);
  if (row.reason) make("div", details, row.reason);
  make("div", details, `${row.planner}, ${row.simulations} simulations, ${number(row.elapsed_ms, 0)} ms`);
  const grid = make("table", details); grid.id = `decision-${row.step}-${Math.round(1000 * row.t_s)}`;
  table(grid.id, ["action", "value", "visits", "chosen"], row.actions.map((item) => [item.action, number(item.value, 4), String(item.visits), item.action === row.action ? "✓" : ""]))
    .forEach((line, index) => { if (row.actions[index].action === row.action) line.className = "chosen"; });
  return details;
});
const fillHealth = () => {
  table("complaints", ["time", "node", "", "what"], data.complaints.map((row) => ["", row.node, row.level, row.text])).forEach((line, index) => {
    const row = data.complaints[index];
    line.cells[2].className = row.level;
    link(make("button", line.cells[0], seconds(row.t_s)), row.t_s);
  });
  for (const node of new Set(data.complaints.map((row) => row.node))) {
    const lane = make("div", byId("lanes"), "", "lane"), own = data.complaints.filter((row) => row.node === node);
    make("small", lane, node);
    const track = make("div", lane, "", "track");
    own.forEach((row, index) => {
      if (row.level === "ok") return;
      const from = Math.max(0, row.t_s), logged = row.text.endsWith("(log)"), until = logged ? from : own[index + 1] ? own[index + 1].t_s : end;
      const part = make("i", track, "", row.level);
      part.style.left = `${(100 * from) / end}%`; part.style.width = `${(100 * Math.max(0, until - from)) / end}%`; part.title = row.text;
    });
  }
};
const fillLegend = () => {
  const entry = (sign, shade, text) => { make("i", make("li", byId("legend")), sign).style.color = shade; byId("legend").lastChild.append(text); };
  entry("●", color(paint.time, 0.7), "robot and where it looks");
  if (data.goals.length) entry("◌", "inherit", "where it drives");
  if (data.things.some((thing) => thing.wanted)) entry("★", paint.target, "where it really is");
  if (data.marks.some((mark) => mark.wanted && !mark.is_false)) entry("○", paint.belief[230], "detected");
  if (data.marks.some((mark) => mark.is_false)) entry("✕", paint.false_alarm, "false alarm");
  const bar = (scale, text) => {
    entry("", "inherit", text);
    const sign = byId("legend").lastChild.firstChild, some = scale.filter((_, index) => index % 16 === 0);
    sign.className = "bar"; sign.style.background = `linear-gradient(to right, ${some.join(", ")})`;
  };
  if (beliefs.length) bar(paint.belief, "100 × less to 100 × more likely than at first");
  if (data.way.length) bar(paint.time, "way, by time");
};

// --- time ---
const mark = (nodes, chosen, box) => nodes.forEach((node, index) => {
  const was = node.getAttribute("aria-current") === "true";
  node.setAttribute("aria-current", String(index === chosen));
  if (index === chosen && !was) box.scrollTo(node.offsetLeft - box.clientWidth / 2 + 60, node.offsetTop - box.clientHeight / 3);
});
const go = (t) => {
  now = Math.min(end, Math.max(0, t));
  byId("time").value = now; byId("time").setAttribute("aria-valuetext", seconds(now));
  byId("clock").textContent = `${now.toFixed(1)} / ${end.toFixed(1)} s`;
  drawMap(); drawCamera();
  mark(decisions, latest(data.decisions, now), byId("decisions")); mark(thumbs, latest(decided, now), byId("strip"));
  lines.forEach((row, index) => row.classList.toggle("later", data.chat[index].t_s > now + 0.05));
};
const pause = () => { playing = 0; byId("play").textContent = "Play"; };
const play = () => {
  if (now >= end) go(0);
  const run = (playing = ++plays), from = now, speed = Math.max(1, end / 25);
  let begun = null;
  byId("play").textContent = "Pause";
  const tick = (at) => {
    if (playing !== run) return;
    begun ??= at;
    go(from + (speed * (at - begun)) / 1000);
    if (now < end) requestAnimationFrame(tick); else pause();
  };
  requestAnimationFrame(tick);
};
const step = (ahead) => { pause(); go(ahead ? stops.find((t) => t > now + 1e-3) ?? end : stops.findLast((t) => t < now - 1e-3) ?? 0); };

byId("title").textContent = data.title;
byId("source").textContent = data.source;
byId("head").className = data.verdict;
facts("facts", data.facts); facts("run", data.run);
data.missing.forEach((sentence) => make("li", byId("missing"), sentence));
table("changed", ["node", "parameter", "value", "default"], data.changed.map((row) => [row.node, row.name, JSON.stringify(row.value), JSON.stringify(row.default)]));
fillHealth(); fillLegend();
const hide = (id, ...rows) => { byId(id).hidden = !rows.some((row) => row && row.length); };
hide("place", shown); hide("camera", data.frames); hide("talk", data.chat); hide("side", data.frames, data.chat);
hide("controls", shown, data.frames, data.decisions); hide("pictures", data.frames); hide("deciding", data.decisions);
hide("health", data.complaints); hide("making", data.run); hide("changed", data.changed);
document.querySelector("main").classList.toggle("narrow", byId("side").hidden || byId("place").hidden);
byId("time").max = end;
byId("time").addEventListener("input", (event) => { pause(); go(Number(event.target.value)); });
byId("play").addEventListener("click", () => (playing ? pause() : play()));
document.addEventListener("keydown", (event) => {
  if (event.altKey || event.ctrlKey || event.metaKey || byId("controls").hidden) return;
  if (event.key === "ArrowLeft" || event.key === "ArrowRight") { event.preventDefault(); step(event.key === "ArrowRight"); }
  if (event.key === " " && !event.target.closest("button, summary")) { event.preventDefault(); byId("play").click(); }
});
window.addEventListener("resize", () => go(now));
for (const image of [floor, ...pictures].filter(Boolean)) image.addEventListener("load", () => go(now));
go(end);
