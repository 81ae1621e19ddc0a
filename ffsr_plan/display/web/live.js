const [cycleBests, bests] = byId("plot").querySelectorAll("polyline");
const marker = byId("plot").querySelector("line");
let shown = 0, last = 0, summary = "";

function report(text, working) {
  byId("state").textContent = text;
  byId("pulse").classList.toggle("on", working);
}

// F over the cycles, of the best path so far and of the best of each cycle.
function plot(history, cycles) {
  const values = history.flatMap(row => row.slice(1)).filter(f => f !== null);
  const low = Math.min(...values), high = Math.max(...values, low + 1e-9);
  const line = column => history.filter(row => row[column] !== null)
    .map(row => `${1000 * row[0] / cycles},${94 - 88 * (row[column] - low) / (high - low)}`).join(" ");
  cycleBests.setAttribute("points", line(2));
  bests.setAttribute("points", line(1));
}

// A search by trees has no ants, and its ribbons are branches.
function label(trees) {
  byId("trails").textContent = trees ? "trees" : "pheromone";
  byId("ants").style.display = trees ? "none" : "";
}

function draw(cycle) {
  const trees = cycle.nodes !== undefined;
  label(trees);
  run(cycle.commands);
  plot(cycle.history, cycle.cycles);
  for (const end of ["x1", "x2"]) marker.setAttribute(end, 1000 * cycle.number / cycle.cycles);
  const best = cycle.best === null ? "none yet" : cycle.best.toFixed(3);
  summary = `${trees ? "round" : "cycle"} ${cycle.number} of ${cycle.cycles}   best F ${best}`;
  const work = trees ? `${cycle.nodes} nodes, ${cycle.checks} checks`
    : `${cycle.distinct} different paths of ${cycle.ants} ants`;
  report(`${summary}\n${work}`, true);
  last = Date.now();
  document.title = `${++shown} shown: ${data.title}`;
}

label(data.trees);
byId("moving").hidden = !data.bodies;
const source = new EventSource("events");
source.onmessage = event => {
  const message = JSON.parse(event.data);
  if (message.over === undefined) { draw(message); return; }
  source.close();
  last = 0;
  if (message.over === "") location.reload();  // the page of the plan
  else report(message.over, false);
};
source.onerror = () => { source.close(); last = 0; report(`${summary}\nno longer connected`, false); };
setInterval(() => {
  const idle = Math.floor((Date.now() - last) / 1000);
  if (last && idle > 2) report(`${summary}\nno new cycle for ${idle} s`, true);
}, 500);
document.title = "ready: " + data.title;
