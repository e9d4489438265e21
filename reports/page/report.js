(function () {
  "use strict";
  var element = document.getElementById("report");
  if (!element || typeof Dygraph === "undefined") return;
  var report = JSON.parse(element.textContent);
  var groups = [];
  var lastScroll = 0;
  document.documentElement.classList.add("js");
  window.addEventListener("scroll", function () { lastScroll = Date.now(); }, {passive: true});

  function make(tag, attributes, parent) {
    var node = document.createElement(tag);
    Object.keys(attributes || {}).forEach(function (key) {
      if (key === "text") node.textContent = attributes[key];
      else node.setAttribute(key, attributes[key]);
    });
    if (parent) parent.appendChild(node);
    return node;
  }
  function minus(text) { return text.replace("-", "\u2212"); }
  function number(value, digits) {
    if (value === null || !isFinite(value)) return "\u2013";
    var size = Math.abs(value);
    return minus(size >= 1e6 || (size > 0 && size < 1e-4) ? value.toExponential(2) : Number(value.toPrecision(digits || 4)).toFixed(
      Math.max(0, (digits || 4) - 1 - (size > 0 ? Math.floor(Math.log10(size)) : 0))));
  }
  function nearest(times, t) {
    var low = 0, high = times.length - 1;
    while (high - low > 1) {
      var middle = (low + high) >> 1;
      if (times[middle] < t) low = middle; else high = middle;
    }
    return t - times[low] < times[high] - t ? low : high;
  }

  // Multiples of 1, 2 or 5: as the still plots have them.
  function ticker(low, high, pixels, option) {
    var rough = (high - low) / Math.max(1, pixels / option("pixelsPerLabel")), ticks = [];
    if (!(rough > 0)) return ticks;
    var exponent = Math.floor(Math.log10(rough)), fraction = rough / Math.pow(10, exponent);
    var lead = fraction < 1.4142 ? 1 : fraction < 3.1623 ? 2 : fraction < 7.0711 ? 5 : 10;
    var step = lead * Math.pow(10, exponent);
    var decimals = Math.max(0, -exponent - (lead === 10 ? 1 : 0));
    for (var k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
      ticks.push({v: k * step, label: minus((k * step).toFixed(Math.min(decimals, 20)).replace(/^-(0(\.0*)?)$/, "$1"))});
    return ticks;
  }

  // One recording: its plots share the x range and the pointer.
  function Group() {
    this.plots = [];
    this.busy = false;
  }
  Group.prototype.range = function (range, except) {
    if (this.busy) return;
    this.busy = true;
    this.plots.forEach(function (plot) {
      if (plot.graph !== except) plot.graph.updateOptions({dateWindow: range.slice()});
    });
    this.busy = false;
  };
  Group.prototype.show = function (range) {
    this.busy = true;
    this.plots.forEach(function (plot) {
      plot.graph.updateOptions({dateWindow: range.slice(), valueRange: null});
    });
    this.busy = false;
  };
  Group.prototype.point = function (t) {
    this.plots.forEach(function (plot) { plot.point(t); });
  };
  Group.prototype.leave = function () {
    this.plots.forEach(function (plot) { plot.leave(); });
  };
  Group.prototype.full = function () {
    var low = Infinity, high = -Infinity;
    this.plots.forEach(function (plot) {
      low = Math.min(low, plot.times[0]);
      high = Math.max(high, plot.times[plot.times.length - 1]);
    });
    return [low, high];
  };

  function zoomed(graph, group, factor, pivot) {
    var now = graph.xAxisRange(), full = group.full();
    var low = Math.max(full[0], pivot - (pivot - now[0]) * factor);
    var high = Math.min(full[1], pivot + (now[1] - pivot) * factor);
    var least = (full[1] - full[0]) * 1e-5;
    return high - low < least ? now : [low, high];
  }
  // The wheel zooms, except while the page is being scrolled past the plot or there is nothing left to
  // zoom out to: then the page scrolls on.
  function wheel(group) {
    return function (event, graph) {
      if (!event.ctrlKey && Date.now() - lastScroll < 400) return;
      var pivot = graph.toDataXCoord(event.offsetX);
      var step = Math.min(1, Math.abs(event.deltaY) / 100) || 1;
      var range = zoomed(graph, group, Math.pow(event.deltaY < 0 ? 0.8 : 1.25, step), pivot);
      var now = graph.xAxisRange();
      if (range[0] === now[0] && range[1] === now[1]) return;
      event.preventDefault();
      group.range(range);
    };
  }
  // One finger scrolls the page until the plot is zoomed; two fingers zoom.
  function touch(name, group) {
    var standard = Dygraph.defaultInteractionModel[name];
    return function (event, graph, context) {
      var full = group.full(), now = graph.xAxisRange();
      var whole = now[0] <= full[0] && now[1] >= full[1];
      if (event.touches.length > 1 || !whole || context.started) {
        context.started = event.touches.length > 0;
        standard(event, graph, context);
      }
    };
  }
  function interaction(group, view) {
    var standard = Dygraph.defaultInteractionModel, model = {};
    Object.keys(standard).forEach(function (key) { model[key] = standard[key]; });
    model.wheel = wheel(group);
    model.dblclick = function () { group.show(view); };
    model.touchstart = touch("touchstart", group);
    model.touchmove = touch("touchmove", group);
    model.touchend = touch("touchend", group);
    return model;
  }

  // Grey where the fit did not look; not between samples of which it took one in so many.
  function unused(curve, times) {
    var stretches = [], from = -1;
    for (var i = 0; i <= times.length; ++i) {
      var off = i < times.length && !curve.used[i];
      if (off && from < 0) from = i;
      if (!off && from >= 0) {
        if (i - from >= (curve.every || 1)) stretches.push([times[from], times[Math.min(i, times.length - 1)]]);
        from = -1;
      }
    }
    return stretches;
  }
  // What was not fitted, as a clipped crest, may be so far off that nothing is seen of the others.
  function drawnResidual(curve, predicted) {
    var most = 0;
    curve.measured.forEach(function (y, i) {
      if (curve.used[i] && y !== null && predicted[i] !== null) most = Math.max(most, Math.abs(y - predicted[i]));
    });
    return most > 0 ? 1.5 * most : Infinity;
  }
  function backdrop(stretches, band) {
    return function (canvas, area, graph) {
      canvas.fillStyle = "#f0f1f3";
      stretches.forEach(function (stretch) {
        var left = Math.max(area.x, graph.toDomXCoord(stretch[0]));
        var right = Math.min(area.x + area.w, graph.toDomXCoord(stretch[1]));
        if (right > left) canvas.fillRect(left, area.y, right - left, area.h);
      });
      if (band) {
        canvas.fillStyle = "#dfe5ec";
        var top = Math.max(area.y, graph.toDomYCoord(1.96));
        var bottom = Math.min(area.y + area.h, graph.toDomYCoord(-1.96));
        if (bottom > top) canvas.fillRect(area.x, top, area.w, bottom - top);
      }
      var zero = graph.toDomYCoord(0);
      if (zero < area.y || zero > area.y + area.h) return;
      canvas.fillStyle = "#8f969f";
      canvas.fillRect(area.x, Math.round(zero), area.w, 1);
    };
  }

  function options(group, view, spacing, more) {
    var out = {
      dateWindow: view.slice(), legend: "never", animatedZooms: false, yRangePad: 8,
      gridLineColor: "#e3e6ea", axisLineColor: "#c6cdd5", highlightCircleSize: 3.5,
      interactionModel: interaction(group, view), rightGap: 12, xRangePad: 0,
      axes: {
        x: {drawGrid: false, pixelsPerLabel: 90, ticker: ticker},
        y: {axisLabelWidth: 50, pixelsPerLabel: spacing, includeZero: true, ticker: ticker}
      },
      drawCallback: function (graph, first) { if (!first) group.range(graph.xAxisRange(), graph); },
      highlightCallback: function (event, t) { group.point(t); },
      unhighlightCallback: function () { group.leave(); }
    };
    Object.keys(more).forEach(function (key) { out[key] = more[key]; });
    return out;
  }

  function key(parent, label, colour, width, toggle) {
    var button = make("button", {type: "button", "aria-pressed": "true", title: "show or hide " + label}, parent);
    make("i", {style: "color:" + colour + ";border-top-width:" + width + "px"}, button);
    button.appendChild(document.createTextNode(label));
    button.addEventListener("click", function () {
      var shown = button.getAttribute("aria-pressed") === "false";
      button.setAttribute("aria-pressed", String(shown));
      toggle(shown);
    });
  }
  function swatch(parent, label, colour) {
    var box = make("span", {}, parent);
    make("i", {"class": "swatch", style: "background:" + colour}, box);
    box.appendChild(document.createTextNode(label));
  }

  // What stands under the pointer is told above the plot, where nothing is hidden by it.
  function Plot(graph, times, output, tell) {
    this.graph = graph;
    this.times = times;
    this.output = output;
    this.tell = tell;
  }
  Plot.prototype.point = function (t) {
    var row = nearest(this.times, t);
    this.graph.setSelection(row);
    this.output.textContent = this.tell(row);
  };
  Plot.prototype.leave = function () {
    this.graph.clearSelection();
    this.output.textContent = "";
  };

  function panel(live, title, height) {
    var top = make("div", {"class": "top"}, live);
    make("span", {"class": "axis", text: title}, top);
    var output = make("output", {}, top);
    return {output: output, keys: make("span", {"class": "keys"}, top), area: make("div", {"class": height}, live)};
  }
  function bracketed(unit) { return unit ? " [" + unit + "]" : ""; }

  function draw(figure, group) {
    var data = figure.dataset, curve = report.curves[Number(data.curve)];
    if (!curve || curve.time_s.length < 2) return;
    var fx = Number(data.xFactor), fy = Number(data.yFactor), noise = Number(data.noise);
    var view = [Number(data.from) * fx, Number(data.to) * fx];
    function scaled(values, factor) {
      return values.map(function (y) { return y === null ? null : y * factor; });
    }
    var until = data.until === undefined ? Infinity : Number(data.until);
    var predicted = curve.model.map(function (y, i) { return curve.time_s[i] <= until ? y : null; });
    var times = scaled(curve.time_s, fx), measured = scaled(curve.measured, fy), model = scaled(predicted, fy);
    var drawn = drawnResidual(curve, predicted);
    var residual = curve.measured.map(function (y, i) {
      var known = y !== null && predicted[i] !== null && Math.abs(y - predicted[i]) <= drawn;
      return known ? (y - predicted[i]) / noise : null;
    });
    var inNoise = data.residualUnit === "noise", stretches = unused(curve, times);
    var still = figure.querySelector("svg"), graph, lower;
    var live = make("div", {"class": "live", role: "group", "aria-label": still ? still.getAttribute("aria-label") : data.name}, figure);
    figure.classList.add("drawn");

    var upper = panel(live, data.name + bracketed(data.yUnit), "history");
    key(upper.keys, "measured", "var(--measured)", 1.5, function (on) { graph.setVisibility(1, on); });
    key(upper.keys, "model", "var(--model)", 4, function (on) { graph.setVisibility(0, on); });
    if (stretches.length) swatch(upper.keys, "not fitted", "#f0f1f3");
    graph = new Dygraph(upper.area, times.map(function (t, i) { return [t, model[i], measured[i]]; }),
      options(group, view, 52, {
        labels: ["t", "model", "measured"], colors: ["#f0862e", "#0f4584"],
        series: {measured: {strokeWidth: 1.1}, model: {strokeWidth: 4}},
        underlayCallback: backdrop(stretches, false)
      }));
    group.plots.push(new Plot(graph, times, upper.output, function (row) {
      return number(times[row], 5) + "\u00a0" + data.xUnit + ": measured " + number(measured[row]) +
        ", model " + number(model[row]) + (data.yUnit ? "\u00a0" + data.yUnit : "");
    }));

    var under = panel(live, "Measured \u2212 model" + bracketed(data.residualUnit), "residual");
    if (inNoise) swatch(under.keys, "95\u00a0% of pure noise", "#dfe5ec");
    lower = new Dygraph(under.area, times.map(function (t, i) { return [t, residual[i]]; }),
      options(group, view, 24, {
        labels: ["t", "residual"], colors: ["#0f4584"], strokeWidth: 0.8,
        underlayCallback: backdrop(stretches, inNoise)
      }));
    group.plots.push(new Plot(lower, times, under.output, function (row) {
      return number(residual[row], 3) + (data.residualUnit ? "\u00a0" + data.residualUnit : "");
    }));
    make("div", {"class": "xaxis", text: "Time after first touch [" + data.xUnit + "]"}, live);
  }

  function tools(block, group, data) {
    var bar = make("div", {"class": "tools"}), fx = Number(data.xFactor);
    [["Contact", function () { group.show([Number(data.from) * fx, Number(data.to) * fx]); }],
     ["Fitted window", function () { group.show([Number(data.fittedFrom) * fx, Number(data.fittedTo) * fx]); }],
     ["Everything", function () { group.show(group.full()); }]].forEach(function (tool) {
      make("button", {type: "button", text: tool[0]}, bar).addEventListener("click", tool[1]);
    });
    block.insertBefore(bar, block.firstChild);
  }

  document.querySelectorAll(".recording").forEach(function (block) {
    var group = new Group(), figures = block.querySelectorAll(".plot");
    figures.forEach(function (figure) { draw(figure, group); });
    if (!group.plots.length) return;
    tools(block, group, figures[0].dataset);
    groups.push(group);
  });

  document.querySelectorAll(".fold").forEach(function (fold) {
    var title = fold.querySelector("h3"), text = title.textContent;
    title.textContent = "";
    var button = make("button", {type: "button", "aria-expanded": "false", text: text}, title);
    fold.classList.add("shut");
    button.addEventListener("click", function () {
      var shut = fold.classList.toggle("shut");
      button.setAttribute("aria-expanded", String(!shut));
    });
  });

  function save(name, type, text) {
    var address = URL.createObjectURL(new Blob([text], {type: type}));
    var link = make("a", {href: address, download: name}, document.body);
    link.click();
    link.remove();
    setTimeout(function () { URL.revokeObjectURL(address); }, 1000);
  }
  function csv(heads, columns) {
    var lines = [heads.join(",")];
    columns[0].forEach(function (unused, i) {
      lines.push(columns.map(function (column) {
        return column[i] === null || column[i] === undefined ? "" : String(column[i]);
      }).join(","));
    });
    return lines.join("\r\n") + "\r\n";
  }
  var downloads = document.querySelector(".downloads");
  function offer(label, name, type, content) {
    make("button", {type: "button", text: label}, downloads).addEventListener("click", function () {
      save(name, type, content());
    });
  }
  downloads.hidden = false;
  offer("All numbers, JSON", "fit.json", "application/json", function () { return element.textContent; });
  report.curves.forEach(function (curve) {
    offer(curve.name + ", CSV", curve.name.replace(/[^a-z0-9]+/gi, "-").replace(/-$/, "") + ".csv", "text/csv", function () {
      var unit = " [" + curve.unit + "]";
      return csv(["time [s]", "measured" + unit, "model" + unit, "used"],
                 [curve.time_s, curve.measured, curve.model, curve.used]);
    });
  });
  report.predictions.forEach(function (run, i) {
    var history = run.history;
    if (!history.force_n.length) return;
    var many = report.predictions.length > 1 ? " " + (i + 1) : "";
    offer("prediction" + many + ", CSV", "prediction" + many.replace(" ", "-") + ".csv", "text/csv", function () {
      return csv(["time [s]", "force [N]", "penetration [m]", "velocity [m/s]", "displacement [m]"],
                 [history.force_n.map(function (unused, k) { return history.start_s + k * history.interval_s; }),
                  history.force_n, history.penetration_m, history.velocity_m_s, history.displacement_m]);
    });
  });
  document.querySelectorAll(".still svg, .loop svg").forEach(function (drawing) {
    var figure = drawing.closest("figure");
    var name = figure.dataset.name ? report.curves[Number(figure.dataset.curve)].name : "loop";
    offer(name + ", SVG", name.replace(/[^a-z0-9]+/gi, "-").replace(/-$/, "") + ".svg", "image/svg+xml", function () {
      return new XMLSerializer().serializeToString(drawing);
    });
  });

  window.impactrig = {report: report, groups: groups};
})();
