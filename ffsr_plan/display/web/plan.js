// Clearance along the motion; the axis begins at contact.
const samples = data.clearances, finite = samples.filter(c => c !== null);
const highest = Math.max(...finite, 1e-9);
byId("plot").querySelector("polyline").setAttribute("points", samples
  .map((c, k) => c === null ? "" : `${1000 * k / (samples.length - 1)},${96 - 90 * c / highest}`)
  .join(" "));

const slider = byId("time"), button = byId("play"), marker = byId("plot").querySelector("line");
viewer.animator.play();
viewer.animator.pause();
function show(s) {
  slider.value = s;
  viewer.animator.seek(s * data.seconds);
  marker.setAttribute("x1", 1000 * s);
  marker.setAttribute("x2", 1000 * s);
  const k = Math.round(s * (samples.length - 1)), c = samples[k];
  const clearance = c === null ? "no obstacle" : c.toFixed(3) + " m";
  byId("state").textContent =
    `s ${s.toFixed(3)}   clearance ${clearance}\nbase rotated ${data.rotations[k].toFixed(2)}\u00b0`;
}
let playing = false, last = 0;
function play(on) { playing = on; last = 0; button.innerHTML = on ? "&#10074;&#10074;" : "&#9654;"; }
function frame(now) {
  if (playing) {
    let s = Number(slider.value) + (last ? (now - last) / 1000 / data.seconds : 0);
    last = now;
    if (s >= 1) { s = 1; play(false); }
    show(s);
  }
  requestAnimationFrame(frame);
}
function step(by) { play(false); show(Math.min(1, Math.max(0, Number(slider.value) + by))); }
button.onclick = () => { if (Number(slider.value) >= 1) show(0); play(!playing); };
slider.oninput = () => step(0);
document.addEventListener("keydown", e => {
  if (e.code === "Space" && !["BUTTON", "SUMMARY"].includes(e.target.tagName)) { e.preventDefault(); button.click(); }
  if (e.code === "ArrowLeft") { e.preventDefault(); step(-0.01); }
  if (e.code === "ArrowRight") { e.preventDefault(); step(0.01); }
});
document.querySelector('#show input[data-path="trails"]').parentElement.hidden = !data.ants;
const wanted = Number(new URLSearchParams(location.search).get("s") ||
                      new URLSearchParams(location.hash.slice(1)).get("s"));
show(wanted >= 0 && wanted <= 1 ? wanted : 0);
requestAnimationFrame(frame);
if (data.playing) button.click();
document.title = "ready: " + data.title;
