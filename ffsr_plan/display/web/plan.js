// The player: `position` is the share of the motion, from 0 to 1.
let position = 0, playing = false, last = 0;
const slider = byId("time"), button = byId("play"), loop = byId("loop"), speed = byId("speed");
viewer.animator.play();
viewer.animator.pause();
for (const factor of [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]) {
  speed.add(new Option(`\u00d7 ${factor}`, factor, false, factor === data.axis.speed));
}
addTicks(byId("ticks"), 8);
function show(s) {
  position = s;
  slider.value = s;
  viewer.animator.seek(s * data.axis.seconds);
  for (const update of updates) update(s);
  moveCamera(s);
  const { symbol, unit, end } = data.axis, digits = end < 20 ? 2 : end < 200 ? 1 : 0;
  byId("state").textContent = unit ? `${(s * end).toFixed(digits)} / ${end.toFixed(digits)} ${unit}`
    : `${symbol} ${s.toFixed(3)}`;
}
// Spheres of debris are instances of one object; in `data.drifts` is how far each goes in all.
if (data.drifts.length) {
  const spheres = viewer.scene_tree.find(["meshcat", "bodies", "debris", "<object>"]).object;
  const placed = spheres.instanceMatrix.array, first = Float32Array.from(placed);
  updates.push(s => {
    data.drifts.forEach((way, k) => {
      for (let a = 0; a < 3; a++) placed[16 * k + 12 + a] = first[16 * k + 12 + a] + s * way[a];
    });
    spheres.instanceMatrix.needsUpdate = true;
    viewer.set_dirty();
  });
}
function play(on) { playing = on; last = 0; button.innerHTML = on ? "&#10074;&#10074;" : "&#9654;"; }
function frame(now) {
  if (playing) {
    let s = position + (last ? (now - last) / 1000 * Number(speed.value) / data.axis.seconds : 0);
    last = now;
    if (s >= 1) { s = loop.checked ? 0 : 1; if (!loop.checked) play(false); }
    show(s);
  }
  placeNames();
  drawCompass();
  requestAnimationFrame(frame);
}
function halt(s) { play(false); show(Math.min(1, Math.max(0, s))); }
button.onclick = () => { if (position >= 1) show(0); play(!playing); };
slider.oninput = () => halt(Number(slider.value));
document.addEventListener("keydown", e => {
  if (["BUTTON", "SUMMARY", "SELECT"].includes(e.target.tagName)) return;
  if (e.code === "Space") { e.preventDefault(); button.click(); }
  if (e.code === "ArrowLeft") { e.preventDefault(); halt(position - 0.01); }
  if (e.code === "ArrowRight") { e.preventDefault(); halt(position + 0.01); }
});
function plot(on) { charts.hidden = !on; document.body.classList.toggle("plotted", on); }
byId("plots").onchange = event => { plot(event.target.checked); fit(); };
margins = () => [0, 60, charts.hidden ? 0 : charts.offsetWidth + 18, 84];
plot(byId("plots").checked = window.innerWidth >= 900);
document.querySelector('#show input[data-path="trails"]').parentElement.hidden = !data.ants;
byId("moving").hidden = !data.bodies.length;
byId("follow").checked = false;

// Wishes at the end of the address, such as #t=30&view=top&follow=1.
const wishes = new URLSearchParams(location.hash.slice(1) || location.search);
const wanted = wishes.has(data.axis.symbol) ? Number(wishes.get(data.axis.symbol)) / data.axis.end
  : Number(wishes.get("s"));
show(wanted >= 0 && wanted <= 1 ? wanted : 0);
follow.checked = wishes.get("follow") === "1";
choose(["top", "side", "front", "body"].find(name => name === wishes.get("view")) || "scene");
requestAnimationFrame(frame);
if (data.playing) button.click();
document.title = "ready: " + data.title;
