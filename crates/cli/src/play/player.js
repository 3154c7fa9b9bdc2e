// Ties the page together: which row is shown, playing, sliders and keys.

// A log without times is played at this many rows of the log a second.
const ROWS_PER_SECOND = 25;
// What the slider of the deviation chooses from: how many times a deviation is drawn.
const GAINS = [1, 2, 5, 10, 20, 50, 100, 200];
// Turn of the view by one press of an arrow key, and by one pixel of a drag [rad].
const [TURN_KEY, TURN_PIXEL] = [0.08, 0.008];
// Time between two frames beyond which the page was hidden or busy [s].
const LONGEST_FRAME_S = 0.25;
// Factor of one step of the zoom.
const ZOOM = 1.25;

(function play() {
  const find = (id) => document.getElementById(id);
  const data = JSON.parse(find("data").textContent);
  const values = data.axis.values;
  const last = values.length - 1;
  const [button, slider, speed] = ["play", "at", "speed"].map(find);
  const [gainSlider, picture, now] = ["gain", "arm", "now"].map(find);
  const arm = makeArm(picture, data);
  const plots = data.channels.length ? makePlots(find("plots"), data, seek) : { draw() {} };
  // Row that is shown, place on the axis, and the time of the last frame while playing [ms].
  let [row, place, frame, playing] = [0, values[0], null, false];

  const gain = () => GAINS[Number(gainSlider.value)];
  const show = (error, digits) => (error === null ? "none" : error.toFixed(Math.min(digits, 3)));

  function draw() {
    arm.draw(row, gain());
    plots.draw(row);
    const number = 1 + row * data.every;
    const time = data.axis.is_time ? `t = ${values[row].toFixed(3)} s, ` : "";
    now.textContent = `${time}row ${number} of ${data.rows}`;
    slider.value = row;
    slider.setAttribute("aria-valuetext", now.textContent);
    data.channels.forEach((channel, k) => {
      for (const name of data.calibrated ? ["nominal", "calibrated"] : ["nominal"]) {
        find(`${name}-${k}`).textContent = show(channel[name][row], channel.decimals);
      }
    });
    for (const output of document.querySelectorAll("output.gain")) output.textContent = gain();
    gainSlider.setAttribute("aria-valuetext", `${gain()} times`);
  }

  function seek(wanted) {
    row = Math.max(0, Math.min(last, wanted));
    place = values[row];
    draw();
  }

  function setPlaying(wanted) {
    playing = wanted;
    button.textContent = playing ? "Pause" : "Play";
    // A reader is told the row when the motion stops, not at every frame of it.
    now.setAttribute("aria-live", playing ? "off" : "polite");
    if (!playing) return;
    if (row === last) seek(0);
    frame = null;
    requestAnimationFrame(step);
  }

  function step(time) {
    if (!playing) return;
    // A page that was hidden goes on where it was.
    const seconds = frame === null ? 0 : Math.min(LONGEST_FRAME_S, (time - frame) / 1000);
    frame = time;
    place += seconds * Number(speed.value) * (data.axis.is_time ? 1 : ROWS_PER_SECOND);
    const next = rowAt(data, place);
    if (next !== row) { row = next; draw(); }
    if (row === last) setPlaying(false); else requestAnimationFrame(step);
  }

  button.addEventListener("click", () => setPlaying(!playing));
  slider.addEventListener("input", () => seek(Number(slider.value)));
  gainSlider.addEventListener("input", draw);
  const change = (action) => () => { action(); draw(); };
  find("front").addEventListener("click", change(() => arm.reset()));
  find("nearer").addEventListener("click", change(() => arm.magnify(ZOOM)));
  find("farther").addEventListener("click", change(() => arm.magnify(1 / ZOOM)));

  picture.addEventListener("pointerdown", (event) => picture.setPointerCapture(event.pointerId));
  picture.addEventListener("pointermove", (event) => {
    if (!picture.hasPointerCapture(event.pointerId)) return;
    arm.turn(-TURN_PIXEL * event.movementX, TURN_PIXEL * event.movementY);
    draw();
  });

  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const pace = event.shiftKey ? 10 : 1;
    const turns = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const moves = { ArrowLeft: row - pace, ArrowRight: row + pace, Home: 0, End: last };
    const zooms = { "+": ZOOM, "-": 1 / ZOOM };
    const { key, target } = event;
    // Sliders and lists use the arrow keys themselves, buttons the space bar.
    const inField = target.matches("input, select");
    if (key === " " && !target.matches("button, select")) setPlaying(!playing);
    else if (target === picture && key in turns) {
      const [azimuth, elevation] = turns[key];
      change(() => arm.turn(TURN_KEY * azimuth, TURN_KEY * elevation))();
    } else if (!inField && key in moves) seek(moves[key]);
    else if (!inField && key in zooms) change(() => arm.magnify(zooms[key]))();
    else return;
    event.preventDefault();
  });

  draw();
})();
