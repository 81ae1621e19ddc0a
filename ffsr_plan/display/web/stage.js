const byId = id => document.getElementById(id);
const viewer = new MeshCat.Viewer(byId("meshcat-pane"));
function run(commands) {
  for (const command of commands) {
    viewer.handle_command_bytearray(Uint8Array.from(atob(command), c => c.charCodeAt(0)));
  }
}
run(data.commands);

// Place the camera so that the whole scene is seen at this aspect ratio above the bar.
function fit() {
  const rise = data.view.elevation, half = Math.tan(data.view.fov * Math.PI / 360);
  const aspect = window.innerWidth / window.innerHeight;
  const deep = data.view.height * Math.sin(rise) + 0.8;
  const away = Math.max(data.view.width / 2 / (half * aspect), deep / 2 / half)
             + data.view.height / 2 * Math.cos(rise);
  const y = -away * Math.cos(rise) - 0.03 * away, z = away * Math.sin(rise);
  viewer.set_property(["Cameras", "default", "rotated", "<object>"], "position", [0, z, -y]);
}
fit();
window.addEventListener("resize", fit);

byId("title").querySelector("h1").textContent = data.title;
byId("title").querySelector("p").textContent = data.subtitle;
for (const box of document.querySelectorAll("#show input")) {
  box.onchange = () =>
    viewer.set_property(["meshcat", box.dataset.path], "visible", box.checked);
}
