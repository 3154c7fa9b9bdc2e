// Draws one plot for each channel: errors over the log, and a cursor at the row that is shown.

// Size of a plot and its margins in its own units; the browser scales it to the page.
const PLOT = { width: 1200, height: 128, left: 78, right: 12, top: 26, bottom: 22 };
// Digits that make two coordinates of a curve different points of the picture.
const CURVE_DIGITS = 1;

// A step of 1, 2 or 5 times a power of ten that gives at most `most` steps over `span`.
function niceStep(span, most) {
  const power = 10 ** Math.floor(Math.log10(span / most));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => span / step <= most);
}

// Multiples of a nice step from `low` to `high`, as numbers and as texts.
function ticks(low, high, most) {
  const step = niceStep(high - low, most);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; k++) {
    found.push({ at: k * step, text: (k * step).toFixed(Math.min(digits, 12)) });
  }
  return found;
}

// `seek` is called with a row when somebody clicks or drags in a plot.
function makePlots(holder, data, seek) {
  const values = data.axis.values;
  const [start, end] = [values[0], values[values.length - 1]];
  const span = end > start ? end - start : 1;
  const inner = PLOT.width - PLOT.left - PLOT.right;
  const bottom = PLOT.height - PLOT.bottom;
  const xOf = (value) => PLOT.left + (inner * (value - start)) / span;
  const breaks = new Set(data.run_starts);
  const template = document.getElementById("arm");
  const plots = data.channels.map(plotOf);

  function plotOf(channel) {
    const series = data.calibrated ? ["nominal", "calibrated"] : ["nominal"];
    let [low, high] = [0, 0];
    for (const name of series) {
      for (const error of channel[name]) {
        if (error !== null) { low = Math.min(low, error); high = Math.max(high, error); }
      }
    }
    if (high === low) [low, high] = [-1, 1];
    const margin = 0.05 * (high - low);
    [low, high] = [low - margin, high + margin];
    const yOf = (error) => bottom - ((bottom - PLOT.top) * (error - low)) / (high - low);

    const svg = template.cloneNode(false);
    for (const name of ["id", "tabindex", "aria-labelledby"]) svg.removeAttribute(name);
    svg.setAttribute("viewBox", `0 0 ${PLOT.width} ${PLOT.height}`);
    svg.setAttribute("class", "plot");
    svg.setAttribute("aria-label",
      `Errors of ${channel.name}, ${channel.title}, over the log; the table has them in numbers`);
    holder.appendChild(svg);
    const title = element(svg, "text", { class: "title", x: PLOT.left, y: 17 });
    title.textContent = `${channel.name}: ${channel.title} [${channel.unit}]`;
    for (const tick of ticks(low, high, 5)) {
      const y = yOf(tick.at).toFixed(1);
      const grid = tick.at === 0 ? "zero" : "axis";
      element(svg, "path", { class: grid, d: `M${PLOT.left} ${y}h${inner}` });
      const place = { x: PLOT.left - 6, y: Number(y) + 4, "text-anchor": "end" };
      element(svg, "text", place).textContent = tick.text;
    }
    for (const tick of ticks(start, start + span, 12)) {
      const x = xOf(tick.at).toFixed(1);
      element(svg, "path", { class: "axis", d: `M${x} ${bottom}v5` });
      const place = { x, y: PLOT.height - 4, "text-anchor": "middle" };
      element(svg, "text", place).textContent = tick.text;
    }
    for (const name of series) {
      element(svg, "path", { class: `curve ${name}-stroke`, d: curve(channel[name], yOf) });
    }
    const cursor = element(svg, "path", { class: "cursor" });
    const dots = series.map((name) => {
      return { name, mark: element(svg, "circle", { class: `mark ${name}-fill`, r: 5 }) };
    });
    listen(svg);
    return { channel, yOf, cursor, dots };
  }

  // A curve broken at missing errors and where a run begins; a lone point becomes a dot.
  function curve(errors, yOf) {
    let d = "";
    let open = false;
    errors.forEach((error, row) => {
      if (error === null) { open = false; return; }
      if (breaks.has(row)) open = false;
      const at = [xOf(values[row]), yOf(error)].map((x) => x.toFixed(CURVE_DIGITS)).join(" ");
      d += open ? `L${at}` : `M${at}h0`;
      open = true;
    });
    return d;
  }

  function listen(svg) {
    const go = (event) => {
      const box = svg.getBoundingClientRect();
      const x = ((event.clientX - box.left) * PLOT.width) / box.width;
      seek(rowAt(data, start + (span * (x - PLOT.left)) / inner));
    };
    svg.addEventListener("pointerdown", (event) => {
      svg.setPointerCapture(event.pointerId);
      go(event);
    });
    svg.addEventListener("pointermove", (event) => {
      if (svg.hasPointerCapture(event.pointerId)) go(event);
    });
  }

  return {
    draw(row) {
      const x = xOf(values[row]);
      for (const plot of plots) {
        plot.cursor.setAttribute("d", `M${x.toFixed(1)} ${PLOT.top}V${bottom}`);
        for (const { name, mark } of plot.dots) {
          const error = plot.channel[name][row];
          mark.setAttribute("visibility", error === null ? "hidden" : "visible");
          if (error === null) continue;
          mark.setAttribute("cx", x.toFixed(1));
          mark.setAttribute("cy", plot.yOf(error).toFixed(1));
        }
      }
    },
  };
}

// Last row whose place on the axis is not beyond `value`; the axis increases.
function rowAt(data, value) {
  const values = data.axis.values;
  let [low, high] = [0, values.length - 1];
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (values[middle] <= value) low = middle; else high = middle - 1;
  }
  return low;
}
