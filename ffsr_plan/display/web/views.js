// Named views, a camera that follows the base, names of obstacles, axes of the world and scale.
const turnRows = data.view.root.slice(0, 3).map(row => row.slice(0, 3));
const toScene = p => turnRows.map((row, k) => dot(row, p) + data.view.root[k][3]);
const turned = v => turnRows.map(row => dot(row, v));

function basePose(s) {
  const at = s * (data.base.length - 1), k = Math.min(Math.floor(at), data.base.length - 2);
  const [a, b] = [data.base[k], data.base[k + 1]];
  return a.map((x, j) => x + (at - k) * (b[j] - x));  // the attitude nearly, which is enough here
}
function rotated([qx, qy, qz, qw], v) {
  const t = cross([qx, qy, qz], v).map(x => 2 * x), more = cross([qx, qy, qz], t);
  return v.map((x, k) => x + qw * t[k] + more[k]);
}

const sides = { scene: oblique, top: [0, -1e-4, 1], side: [0, -1, 0], front: [1, 0, 0] };
let named = "scene", followed = null;  // base origin that the camera has moved to, axes of the scene
const follow = byId("follow");
function choose(name) {
  named = name;
  for (const each of document.querySelectorAll("#views button")) {
    each.classList.toggle("on", each.dataset.view === name);
  }
  byId("title").style.maxWidth = `min(46vw, ${byId("show").offsetLeft - 58}px)`;
  byId("views").style.top = `${byId("title").offsetTop + byId("title").offsetHeight + 8}px`;
  const near = follow.checked, base = toScene(basePose(position).slice(0, 3));
  followed = near ? base : null;
  if (name === "body") ride(position);
  else if (near) look(sides[name], base, box(Array(3).fill(2.2 * data.body.size)));
  else look(sides[name], [0, 0, 0], box(data.view.size));
}
fit = () => choose(named);

// Behind the base and above it, rotating with it.
function ride(s) {
  const pose = basePose(s), attitude = pose.slice(3), size = data.body.size;
  const ahead = turned(rotated(attitude, data.body.heading)), up = turned(rotated(attitude, data.body.up));
  const target = plus(toScene(pose.slice(0, 3)), ahead, 0.8 * size);
  viewer.camera.up.set(...upwards(up));
  viewer.camera.position.set(...upwards(plus(plus(target, ahead, -4.2 * size), up, 2.2 * size)));
  viewer.controls.target.set(...upwards(target));
  viewer.controls.update();
  viewer.set_dirty();
}
function moveCamera(s) {
  if (named === "body") { ride(s); return; }
  if (!followed) return;
  const base = toScene(basePose(s).slice(0, 3)), step = upwards(plus(base, followed, -1));
  for (const point of [viewer.camera.position, viewer.controls.target]) {
    point.set(point.x + step[0], point.y + step[1], point.z + step[2]);
  }
  followed = base;
  viewer.controls.update();
}
for (const each of document.querySelectorAll("#views button")) {
  each.onclick = () => choose(each.dataset.view);
}
follow.onchange = () => choose(named === "body" ? "scene" : named);

const tags = data.names.map(name => {
  const tag = document.createElement("span");
  tag.textContent = name.text;
  byId("names").append(tag);
  return [tag, name.way ? name.way.map(([share, ...at]) => [share, ...toScene(at)]) : [[0, ...toScene(name.at)]]];
});
// Where a name is now: moving bodies have ways, of which each row is a share of the motion and a place.
function placeOf(way) {
  const next = way.findIndex(row => row[0] >= position);
  if (next < 1) return way.at(next).slice(1);
  const [a, b] = [way[next - 1], way[next]];
  return plus(a.slice(1), plus(b.slice(1), a.slice(1), -1), (position - a[0]) / (b[0] - a[0]));
}
byId("named").onchange = event => { byId("names").hidden = !event.target.checked; };
byId("named").parentElement.hidden = !tags.length;
function placeNames() {
  for (const [tag, way] of tags) {
    const seen = viewer.camera.position.clone().set(...upwards(placeOf(way))).project(viewer.camera);
    tag.style.display = Math.abs(seen.z) < 1 ? "" : "none";
    tag.style.left = `${(seen.x + 1) / 2 * window.innerWidth}px`;
    tag.style.top = `${(1 - seen.y) / 2 * window.innerHeight}px`;
  }
}

// A round length of about as many pixels.
function roundLength(metres) {
  const power = 10 ** Math.floor(Math.log10(metres));
  return power * [5, 2, 1].find(k => k * power <= metres);
}
function drawCompass() {
  const canvas = byId("compass"), pen = canvas.getContext("2d"), [x0, y0, long] = [52, 62, 36];
  const sharp = window.devicePixelRatio || 1;
  canvas.width = 170 * sharp; canvas.height = 136 * sharp;
  pen.scale(sharp, sharp);
  pen.font = '12px system-ui, "DejaVu Sans", sans-serif';
  pen.textAlign = "center"; pen.textBaseline = "middle"; pen.lineWidth = 2;
  const m = viewer.camera.matrixWorldInverse.elements;
  const axes = ["x", "y", "z"].map((name, k) => {
    const d = upwards(turnRows.map(row => row[k]));
    const seen = [0, 1, 2].map(j => m[j] * d[0] + m[j + 4] * d[1] + m[j + 8] * d[2]);
    return { name, seen, colour: ["#e5646a", "#6cc27a", "#6aa3f0"][k] };
  }).sort((a, b) => a.seen[2] - b.seen[2]);
  for (const { name, seen, colour } of axes) {
    pen.strokeStyle = pen.fillStyle = colour;
    pen.beginPath(); pen.moveTo(x0, y0); pen.lineTo(x0 + long * seen[0], y0 - long * seen[1]); pen.stroke();
    const flat = Math.hypot(seen[0], seen[1]) || 1;
    pen.fillText(name, x0 + (long * seen[0] + 10 * seen[0] / flat), y0 - (long * seen[1] + 10 * seen[1] / flat));
  }
  const away = viewer.camera.position.distanceTo(viewer.controls.target);
  const pixels = window.innerHeight / 2 / (Math.tan(data.view.fov * Math.PI / 360) * away);
  const length = roundLength(120 / pixels), end = 14 + length * pixels;
  pen.strokeStyle = pen.fillStyle = "#d8dee9"; pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(14, 116); pen.lineTo(14, 122); pen.lineTo(end, 122); pen.lineTo(end, 116);
  pen.stroke();
  canvas.dataset.scale = `${length >= 1000 ? length.toPrecision(1) : Number(length.toPrecision(1))} m`;
  pen.fillText(canvas.dataset.scale, (14 + end) / 2, 110);
}
