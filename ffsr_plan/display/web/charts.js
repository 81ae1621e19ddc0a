// Plots over the motion, one below the other, with a line at the position of the robot.
const charts = byId("charts");
const across = k => 1000 * k / (data.base.length - 1);
// With as many decimals as the peak needs for three digits.
function short(value, peak) {
  const decimals = Math.min(Math.max(2 - Math.floor(Math.log10(peak)), 0), 12);
  return Number(value.toFixed(decimals)).toString();
}
function shortBelow(value) {
  if (!(value > 0)) return "0";
  const decimals = Math.min(Math.max(2 - Math.floor(Math.log10(value)), 0), 12), power = 10 ** decimals;
  return Number((Math.floor(value * power) / power).toFixed(decimals)).toString();
}
function polyline(values, place, colour) {
  return `<polyline fill="none" stroke="${colour}" stroke-width="1.5" vector-effect="non-scaling-stroke"
    points="${values.map((v, k) => `${across(k)},${place(v)}`).join(" ")}"/>`;
}
function level(value, place, colour, dashes) {
  return `<line x1="0" x2="1000" y1="${place(value)}" y2="${place(value)}" stroke="${colour}"
    stroke-width="1" stroke-dasharray="${dashes}" vector-effect="non-scaling-stroke"/>`;
}
const updates = data.charts.map(chart => {
  const values = chart.curves.flatMap(curve => curve.values);
  const peak = Math.max(...values.map(Math.abs), 1e-12), near = chart.limits.filter(l => l <= 2.5 * peak);
  const signed = Math.min(...values) < -1e-3 * peak;
  const high = Math.max(...values, ...near, signed ? 0 : 1e-12);
  const low = signed ? Math.min(...values, ...near.map(l => -l), 0) : 0;
  const place = v => 95 - 88 * (v - low) / (high - low || 1);
  const figure = document.createElement("figure");
  figure.dataset.name = chart.name;
  const lines = [...near, ...(signed ? near.map(l => -l) : [])].map(l => level(l, place, "#e5646a", "5 4"));
  figure.innerHTML = `<figcaption><b></b> <span></span><output></output></figcaption>
    <div class="plot"><svg preserveAspectRatio="none" viewBox="0 0 1000 100">${level(0, place, "#3a455c", "none")}
    ${lines.join("")}${chart.curves.map(c => polyline(c.values, place, c.colour)).join("")}
    <line class="now" y1="0" y2="100" stroke="#f0b429" stroke-width="1.2" vector-effect="non-scaling-stroke"/>
    </svg><i class="high"></i><i class="low"></i></div><div class="curves"></div>`;
  figure.querySelector("b").textContent = chart.title;
  figure.querySelector("span").textContent = `[${chart.unit}]`;
  figure.querySelector(".high").textContent = short(high, peak);
  figure.querySelector(".low").textContent = short(low, peak);
  const list = figure.querySelector(".curves"), few = chart.curves.length <= 8;
  const readings = chart.curves.length === 1 ? [figure.querySelector("output")]
    : few ? chart.curves.map(curve => {
      const entry = document.createElement("span");
      entry.innerHTML = `<i style="background:${curve.colour}"></i> <em></em> <output></output>`;
      entry.querySelector("em").textContent = curve.label;
      list.append(entry);
      return entry.querySelector("output");
    }) : [];
  if (!few) list.textContent = `${chart.curves.length} curves`;
  if (chart.limits.length) {
    const [least, most] = [Math.min(...chart.limits), Math.max(...chart.limits)];
    const words = document.createElement("span");
    words.className = "limit";
    const lower = chart.bound.startsWith("proven");  // rounded down, so that it stays proven
    const shown = lower ? shortBelow(least) : short(least, least);
    words.textContent = `${chart.bound} ${shown}${most > least ? ` to ${short(most, most)}` : ""} ${chart.unit}`;
    list.append(words);
  }
  charts.append(figure);
  const now = figure.querySelector(".now");
  return s => {
    for (const end of ["x1", "x2"]) now.setAttribute(end, 1000 * s);
    const at = s * (data.base.length - 1), k = Math.min(Math.floor(at), data.base.length - 2);
    readings.forEach((output, j) => {
      const v = chart.curves[j].values;
      output.textContent = short(v[k] + (at - k) * (v[k + 1] - v[k]), peak);
    });
  };
});

// Round numbers along the axis of the motion.
function addTicks(element, most) {
  const step = [1, 2, 5, 10].map(k => k * 10 ** Math.floor(Math.log10(data.axis.end / most)))
    .find(k => data.axis.end / k <= most);
  for (let k = 0; k * step <= data.axis.end * (1 + 1e-9); k++) {
    const tick = document.createElement("span");
    tick.textContent = Number((k * step).toPrecision(6));
    tick.style.left = `${100 * k * step / data.axis.end}%`;
    element.append(tick);
  }
}
const axis = document.createElement("div");
axis.className = "ticks";
charts.append(axis);
addTicks(axis, 5);
const words = document.createElement("p");
words.textContent = data.axis.title;
charts.append(words);

// A table of moving bodies: how near each comes, and when. A press on a row goes there.
if (data.bodies.length) {
  const table = document.createElement("table");
  table.id = "bodies";
  table.innerHTML = "<tr><th>moving body</th><th>motion</th><th>nearest</th><th>at</th></tr>";
  for (const body of data.bodies) {
    const row = table.insertRow();
    const cells = [body.name, body.motion, `${body.least.toFixed(3)} m`, `${body.time.toFixed(1)} s`];
    for (const text of cells) row.insertCell().textContent = text;
    row.onclick = () => halt(body.time / data.axis.end);
  }
  charts.append(table);
}

// A press on a plot moves the robot there.
let held = false;
function seek(event) {
  const plot = event.target.closest(".plot");
  if (!plot) return;
  const { left, width } = plot.getBoundingClientRect();
  halt(Math.min(1, Math.max(0, (event.clientX - left) / width)));
}
charts.addEventListener("pointerdown", event => { held = true; seek(event); });
charts.addEventListener("pointermove", event => { if (held) seek(event); });
window.addEventListener("pointerup", () => { held = false; });
