// Draws the arm: orthographic projection, nominal and calibrated stick figure, measured points.
"use strict";

// Azimuth and elevation of the three-quarter view that the page opens with [rad].
const FIRST_VIEW = { azimuth: 0.9, elevation: 0.42 };

// Small vector functions on arrays of three numbers.
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [0, 1, 2].map((k) => {
  const [i, j] = [(k + 1) % 3, (k + 2) % 3];
  return a[i] * b[j] - a[j] * b[i];
});
const plus = (a, b, k) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
const unit = (a) => {
  const size = Math.hypot(...a);
  return size > 0 ? a.map((x) => x / size) : [0, 0, 1];
};
const point = (flat, index) => flat.slice(3 * index, 3 * index + 3);

// A new element of the drawing that `parent` belongs to.
function element(parent, name, attributes) {
  const made = document.createElementNS(parent.namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent.appendChild(made);
  return made;
}

function makeArm(svg, data) {
  const [width, height] = [800, 560];
  // Three axes with the third upwards, so that an azimuth turns about the vertical.
  const up = unit(data.up);
  const sizes = up.map(Math.abs);
  const smallest = sizes.indexOf(Math.min(...sizes));
  const first = unit(cross(up, [0, 1, 2].map((k) => (k === smallest ? 1 : 0))));
  const second = cross(up, first);
  const exits = data.channels.filter((channel) => channel.exit_um);
  let view = { ...FIRST_VIEW };
  const { centre, largest } = middle();
  const fitted = fit();
  let zoom = 1;

  // Calls `each` with every point that is drawn without exaggeration [um].
  function visit(each) {
    for (const row of data.origins_um) for (let k = 0; k < row.length / 3; k++) each(point(row, k));
    for (const channel of exits) each(channel.exit_um);
  }

  // Middle of the box about all points, which the view turns about, and half its longest side.
  function middle() {
    const [low, high] = [[0, 0, 0], [0, 0, 0]];
    visit((p) => p.forEach((x, k) => {
      low[k] = Math.min(low[k], x);
      high[k] = Math.max(high[k], x);
    }));
    const half = low.map((x, k) => (high[k] - x) / 2);
    return { centre: low.map((x, k) => x + half[k]), largest: Math.max(1, ...half) };
  }

  // A point as the viewer sees it: to the right and upwards of the middle [um].
  function turned(p) {
    const [sa, ca] = [Math.sin(view.azimuth), Math.cos(view.azimuth)];
    const [se, ce] = [Math.sin(view.elevation), Math.cos(view.elevation)];
    const from = plus(p, centre, -1);
    const [u, v, w] = [dot(from, first), dot(from, second), dot(from, up)];
    return [ca * v - sa * u, ce * w - se * (ca * u + sa * v)];
  }

  // Picture units per um with which the whole log has room in the first view.
  function fit() {
    let most = 1e-9;
    visit((p) => {
      const [x, y] = turned(p).map(Math.abs);
      most = Math.max(most, x / (0.46 * width), y / (0.44 * height));
    });
    return 1 / most;
  }

  // Picture coordinates of a point [um]: x to the right, y downwards.
  function project(p) {
    const [x, y] = turned(p);
    return [width / 2 + zoom * fitted * x, height / 2 - zoom * fitted * y];
  }

  const shown = (p) => project(p).map((x) => x.toFixed(1)).join(" ");
  const path = (points) => `M${points.map(shown).join("L")}`;

  // The elements, from the back to the front; moved, not made again, at every row.
  const parts = element(svg, "g", {});
  const triad = element(parts, "path", { class: "frame" });
  const names = ["x", "y", "z"].map((name) => {
    const text = element(parts, "text", {});
    text.textContent = name;
    return text;
  });
  const fixed = element(parts, "path", { class: "fixed" });
  const base = element(parts, "rect", { class: "base", width: 14, height: 14 });
  // A joint at every frame between base and handle, the base included.
  const joint = (name) => element(parts, "circle", { class: `joint ${name}-stroke`, r: 4.5 });
  const jointCount = data.origins_um[0].length / 3 - 2;
  const arms = (data.calibrated ? ["nominal", "calibrated"] : ["nominal"]).map((name) => ({
    name,
    cables: exits.map(() => element(parts, "path", { class: `cable ${name}-stroke` })),
    line: element(parts, "path", { class: `line ${name}-stroke` }),
    joints: Array.from({ length: jointCount }, () => joint(name)),
    handle: name === "nominal"
      ? element(parts, "rect", { class: "mark nominal-fill", width: 15, height: 15 })
      : element(parts, "circle", { class: "mark calibrated-fill", r: 9 }),
    ends: exits.map(() => element(parts, "path", { class: "mark measured" })),
  }));
  const tracked = element(parts, "path", { class: "measured-stroke" });
  const bar = element(parts, "path", { class: "frame" });
  const barText = element(parts, "text", { "text-anchor": "middle" });

  // A length of 1, 2 or 5 times a power of ten below a quarter of the picture.
  function drawScale() {
    const scale = zoom * fitted;
    const most_um = (0.25 * width) / scale;
    const power = 10 ** Math.floor(Math.log10(most_um));
    const length = [5, 2, 1].find((k) => k * power <= most_um) * power;
    bar.setAttribute("d", `M20 ${height - 22}v8h${(scale * length).toFixed(1)}v-8`);
    barText.setAttribute("x", 20 + (scale * length) / 2);
    barText.setAttribute("y", height - 22);
    const [size, name] = length >= 1e6 ? [1e6, "m"] : length >= 1e3 ? [1e3, "mm"] : [1, "µm"];
    barText.textContent = `${length / size} ${name}`;
  }

  function drawAxes() {
    const tips = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => axis.map((x) => 0.2 * largest * x));
    triad.setAttribute("d", tips.map((tip) => path([[0, 0, 0], tip])).join(""));
    tips.forEach((tip, k) => {
      const [x, y] = project(tip.map((t) => 1.18 * t));
      names[k].setAttribute("x", x - 4);
      names[k].setAttribute("y", y + 4);
    });
  }

  const centreAt = (part, p, half) => {
    const [x, y] = project(p);
    const [a, b] = half ? ["x", "y"] : ["cx", "cy"];
    part.setAttribute(a, (x - half).toFixed(1));
    part.setAttribute(b, (y - half).toFixed(1));
  };

  // Draws row `index`; deviations and errors are multiplied by `gain`.
  function draw(index, gain) {
    const flat = data.origins_um[index];
    const count = flat.length / 3;
    const nominal = Array.from({ length: count }, (_, k) => point(flat, k));
    const shift = data.calibrated ? data.deviations_um[index] : null;
    drawScale();
    drawAxes();
    fixed.setAttribute("d", path(nominal.slice(0, 2)));
    centreAt(base, nominal[1], 7);
    for (const arm of arms) {
      const isNominal = arm.name === "nominal";
      const points = isNominal ? nominal : nominal.map((p, k) => plus(p, point(shift, k), gain));
      const handle = points[count - 1];
      arm.line.setAttribute("d", path(points.slice(1)));
      arm.joints.forEach((joint, k) => centreAt(joint, points[k + 1], 0));
      centreAt(arm.handle, handle, isNominal ? 7.5 : 0);
      exits.forEach((channel, k) => {
        arm.cables[k].setAttribute("d", path([channel.exit_um, handle]));
        // The error is model minus measurement [um]: the measured end lies that much nearer.
        const error = channel[arm.name][index];
        arm.ends[k].setAttribute("visibility", error === null ? "hidden" : "visible");
        if (error === null) return;
        const along = unit(plus(handle, channel.exit_um, -1));
        const [x, y] = project(plus(handle, along, -gain * error));
        arm.ends[k].setAttribute("d", `M${x.toFixed(1)} ${(y - 7).toFixed(1)}l7 7l-7 7l-7 -7z`);
      });
    }
    const seen = data.tracked_um ? data.tracked_um[index] : null;
    tracked.setAttribute("visibility", seen ? "visible" : "hidden");
    if (seen) {
      const handle = nominal[count - 1];
      const [x, y] = project(plus(handle, plus(seen, handle, -1), gain));
      tracked.setAttribute("d", `M${(x - 9).toFixed(1)} ${y.toFixed(1)}h18m-9 -9v18`);
    }
  }

  return {
    draw,
    turn(azimuth, elevation) {
      view.azimuth += azimuth;
      const steepest = Math.PI / 2;
      view.elevation = Math.max(-steepest, Math.min(steepest, view.elevation + elevation));
    },
    magnify(factor) { zoom = Math.max(0.2, Math.min(50, zoom * factor)); },
    reset() { view = { ...FIRST_VIEW }; zoom = 1; },
  };
}
