const byId = id => document.getElementById(id);
const viewer = new MeshCat.Viewer(byId("meshcat-pane"));
function run(commands) {
  for (const command of commands) {
    viewer.handle_command_bytearray(Uint8Array.from(atob(command), c => c.charCodeAt(0)));
  }
}
run(data.commands);

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, b, by = 1) => a.map((x, k) => x + by * b[k]);
const unit = a => a.map(x => x / Math.hypot(...a));
const upwards = ([x, y, z]) => [x, z, -y];  // axes of the scene to those of the camera, y upwards

// Near and far planes by the camera's place: fixed ones would cut off wide scenes, or be too coarse.
function setDepth() {
  const { camera, controls } = viewer, away = camera.position.distanceTo(controls.target);
  camera.near = Math.min(0.01 * Math.max(away, 0.1), 10);
  camera.far = 1.1 * (camera.position.length() + data.view.reach) + 1;
  camera.updateProjectionMatrix();
}
viewer.controls.addEventListener("change", setDepth);

// The part of the window that panels leave free: left, top, right, bottom.
let margins = () => [0, 0, 0, 90];

// Put the camera on the side `back` of a target so that all corners, given about it, are seen.
function look(back, target, corners) {
  const [left, top, right, bottom] = margins(), wide = window.innerWidth, high = window.innerHeight;
  const half = Math.tan(data.view.fov * Math.PI / 360);
  const [w, h] = [half * (wide - left - right) / high, half * (high - top - bottom) / high];
  const sideways = unit(cross(Math.abs(back[2]) > 0.999 ? [0, 1, 0] : [0, 0, 1], back));
  const above = cross(back, sideways);
  const away = 1.03 * Math.max(...corners.map(c =>
    Math.max(Math.abs(dot(c, sideways)) / w, Math.abs(dot(c, above)) / h) + dot(c, back)));
  viewer.camera.setViewOffset(wide, high, (right - left) / 2, (bottom - top) / 2, wide, high);
  viewer.camera.up.set(0, 1, 0);
  viewer.camera.position.set(...upwards(plus(target, back, away)));
  viewer.controls.target.set(...upwards(target));
  viewer.controls.update();
  setDepth();
  viewer.set_dirty();
}
function box(size) {
  const corners = [];
  for (const x of [-0.5, 0.5]) for (const y of [-0.5, 0.5]) for (const z of [-0.5, 0.5]) {
    corners.push([x * size[0], y * size[1], z * size[2]]);
  }
  return corners;
}
const oblique = [0, -Math.cos(data.view.elevation), Math.sin(data.view.elevation)];
let fit = () => look(oblique, [0, 0, 0], box(data.view.size));
fit();
window.addEventListener("resize", () => fit());

byId("title").querySelector("h1").textContent = data.title;
byId("title").querySelector("p").textContent = data.subtitle;
for (const chosen of document.querySelectorAll("#show input[data-path]")) {
  chosen.onchange = () =>
    viewer.set_property(["meshcat", chosen.dataset.path], "visible", chosen.checked);
}
