// Draws the page's plots with dygraphs: zoom by dragging, values under the pointer or by arrow keys, series switched
// in the legend, linear or logarithmic axes. The data are in the page (script element "plots").
(function () {
  "use strict";
  var STYLE = getComputedStyle(document.documentElement);
  function colour(word) { return STYLE.getPropertyValue("--" + word).trim() || "#888"; }
  // Series of one origin differ in shade: as it is, towards the ink, towards the paper.
  function shade(word, variant) {
    var base = colour(word), other = variant % 3 === 1 ? colour("ink") : colour("paper");
    if (variant % 3 === 0 || word === "published-model" || !/^#[0-9a-f]{6}$/i.test(base) || !/^#[0-9a-f]{6}$/i.test(other)) return base;
    var mixed = "#";
    for (var i = 1; i < 7; i += 2) {
      var part = Math.round(0.6 * parseInt(base.substr(i, 2), 16) + 0.4 * parseInt(other.substr(i, 2), 16));
      mixed += (part < 16 ? "0" : "") + part.toString(16);
    }
    return mixed;
  }
  // Abscissae as written in the page: a list, evenly spaced, or those of an earlier series. Ordinates: a list, or
  // whole steps, each less the one before.
  function unpack(plot) {
    plot.series.forEach(function (s) {
      if (typeof s.x === "number") s.x = plot.series[s.x].x;
      else if (!Array.isArray(s.x)) { var x = s.x; s.x = Array.from({ length: x.n }, function (_, i) { return x.from + i * x.step; }); }
      if (!Array.isArray(s.y)) {
        var y = s.y, at = 0;
        s.y = y.d.map(function (d) { if (d === null) return null; at += d; return y.from + at * y.step; });
      }
    });
    // A record that goes back along the abscissa (a loop) is drawn as the points it is.
    plot.series.forEach(function (s) {
      if (s.line && !s.points && s.x.some(function (x, i) { return i > 0 && x < s.x[i - 1]; })) { s.line = false; s.points = true; }
    });
    return plot;
  }
  // Numbers along an axis: as short as they can be.
  function tick(v) {
    var size = Math.abs(v);
    return size > 0 && (size < 1e-3 || size >= 1e6) ? Number(v.toPrecision(6)).toExponential() : String(Number(v.toPrecision(8)));
  }
  function shown(v) { return v === null || v === undefined || isNaN(v) ? "" : String(Number(v.toPrecision(5))); }

  // Series with their own x values become columns over all of them; null where a series has no value.
  function table(plot) {
    var banded = plot.series.some(function (s) { return s.low && s.line && !s.points; });
    var row_of = new Map(), rows = [];
    plot.series.forEach(function (s, k) {
      var used = new Set();
      s.x.forEach(function (x, i) {
        // Several points of one series may share an x: each gets a row of its own.
        var list = row_of.get(x);
        if (!list) { list = []; row_of.set(x, list); }
        var row = list.find(function (r) { return !used.has(r); });
        if (!row) {
          row = [x];
          for (var c = 0; c < plot.series.length; ++c) row.push(banded ? [null, null, null] : null);
          list.push(row); rows.push(row);
        }
        used.add(row);
        var y = s.y[i];
        if (y === null) y = NaN;
        row[k + 1] = banded ? (s.low && s.line && !s.points ? [s.low[i], y, s.high[i]] : [y, y, y]) : y;
        row["i" + k] = i;
      });
    });
    rows.sort(function (a, b) { return a[0] - b[0]; });
    return { rows: rows, banded: banded };
  }

  function shape(kind, ctx, x, y, size) {
    ctx.beginPath();
    if (kind === "published-model0") ctx.rect(x - size, y - size, 2 * size, 2 * size);
    else if (kind === "published-model1") { ctx.moveTo(x, y - 1.3 * size); ctx.lineTo(x + 1.3 * size, y); ctx.lineTo(x, y + 1.3 * size); ctx.lineTo(x - 1.3 * size, y); ctx.closePath(); }
    else if (kind.indexOf("synthetic") === 0) { ctx.moveTo(x, y - size); ctx.lineTo(x + size, y + size); ctx.lineTo(x - size, y + size); ctx.closePath(); }
    else if (kind === "modelled1") { ctx.moveTo(x - size, y - size); ctx.lineTo(x + size, y + size); ctx.moveTo(x - size, y + size); ctx.lineTo(x + size, y - size); }
    else if (kind === "modelled2") ctx.arc(x, y, size, 0, 2 * Math.PI);
    else if (kind.indexOf("modelled") === 0) {  // reaches out of a point that it lies on
      size *= 1.5; ctx.moveTo(x - size, y); ctx.lineTo(x + size, y); ctx.moveTo(x, y - size); ctx.lineTo(x, y + size);
    }
    else ctx.arc(x, y, size, 0, 2 * Math.PI);
  }

  function kind_of(s) { return s.origin + (s.origin === "modelled" ? s.variant % 3 : s.variant % 2); }
  function hollow(s) { return s.origin === "published-model" || (s.origin === "modelled" ? s.variant % 3 === 2 : s.variant % 2 === 1); }
  function pattern(s) { return s.dashed ? [7, 4] : [null, [9, 3], [2, 3], [9, 3, 2, 3]][Math.floor(s.variant / 3) % 4]; }

  // All points with their bars; of bars that would flatten everything else, a part.
  function y_range(plot) {
    var low = Infinity, high = -Infinity, least = Infinity, most = -Infinity, bars = [], log = plot.log_y;
    function at(v) { return log ? Math.log(v) : v; }
    plot.series.forEach(function (s) {
      s.y.forEach(function (y, i) {
        if (y === null || isNaN(y) || (log && y <= 0)) return;
        low = Math.min(low, at(y)); high = Math.max(high, at(y));
        if (!s.low || s.low[i] === null || s.high[i] === null) return;
        var from = !log || s.low[i] > 0 ? at(s.low[i]) : at(y), to = at(s.high[i]);
        if (!s.points) { low = Math.min(low, from); high = Math.max(high, to); return; }
        bars.push((to - from) / 2); least = Math.min(least, from); most = Math.max(most, to);
      });
    });
    if (!bars.length || !(low <= high)) return null;
    bars.sort(function (a, b) { return a - b; });
    var room = Math.max(1.5 * (high - low), 1.2 * bars[Math.floor(bars.length / 2)]);
    least = Math.max(least, low - room); most = Math.min(most, high + room);
    low = Math.min(low, least); high = Math.max(high, most);
    var margin = 0.06 * (high - low) || 0.1 * Math.abs(high) || 1;
    return log ? [Math.exp(low - margin), Math.exp(high + margin)] : [low - margin, high + margin];
  }

  // Ticks of an axis that counts.
  function whole_numbers(from, to) {
    var ticks = [];
    for (var v = Math.ceil(from); v <= to; ++v) ticks.push({ v: v, label: String(v) });
    return ticks;
  }

  function draw(host, plot) {
    var data = table(plot);
    var labels = ["x"], options = {};
    var overlaid = plot.series.some(function (s) { return s.line && s.origin === "modelled"; });
    plot.series.forEach(function (s, k) {
      var name = s.name;
      while (labels.indexOf(name) >= 0) name += " ";
      labels.push(name);
      var line_colour = shade(s.origin, s.variant), dense = s.x.length > 150;
      var kind = kind_of(s);
      options[name] = {
        color: line_colour,
        connectSeparatedPoints: true,
        // A test that a model lies on is seen beneath it.
        strokeWidth: !s.line ? 0 : overlaid && s.origin !== "modelled" ? 3.2 : s.x.length > 700 ? 1.3 : 1.8,
        strokePattern: pattern(s),
        drawPoints: !!s.points, pointSize: s.points ? (dense ? (s.variant % 2 ? 1.5 : 2.5) : 4.5) : 1, highlightCircleSize: 6,
        drawPointCallback: function (g, series, ctx, x, y, c, size, idx) {
          ctx.save();
          ctx.strokeStyle = line_colour; ctx.lineWidth = 1.6;
          if (dense) { ctx.fillStyle = line_colour; ctx.beginPath(); ctx.arc(x, y, size, 0, 2 * Math.PI); ctx.fill(); ctx.restore(); return; }
          if (s.low) {
            var i = data.rows[idx]["i" + k], low = s.low[i], high = s.high[i];
            if (low !== null && high !== null) {
              var a = g.toDomYCoord(low), b = g.toDomYCoord(high);
              ctx.beginPath(); ctx.moveTo(x, a); ctx.lineTo(x, b); ctx.moveTo(x - 4, a); ctx.lineTo(x + 4, a); ctx.moveTo(x - 4, b); ctx.lineTo(x + 4, b); ctx.stroke();
            }
          }
          shape(kind, ctx, x, y, size);
          ctx.fillStyle = hollow(s) ? colour("paper") : line_colour;
          ctx.fill(); ctx.stroke();
          ctx.restore();
        }
      };
    });
    var xs = data.rows.map(function (r) { return r[0]; });
    var low = Math.min.apply(null, xs), high = Math.max.apply(null, xs), margin = 0.04 * (high - low || 1);
    // dygraphs pads a logarithmic abscissa below zero: its range is said.
    var whole = plot.log_x ? [low / Math.pow(high / low, 0.03), high * Math.pow(high / low, 0.03)] : [low - margin, high + margin];
    var readout = host.parentNode.querySelector(".readout"), y_whole = y_range(plot);
    var counted = !plot.log_x && high - low <= 20 && xs.every(function (x) { return Number.isInteger(x); });
    var x_axis = { logscale: plot.log_x, axisLabelFormatter: tick, gridLineColor: colour("rule"), axisLineColor: colour("soft") };
    if (counted) x_axis.ticker = whole_numbers;
    var g = new Dygraph(host, data.rows, {
      labels: labels, series: options, customBars: data.banded, fillAlpha: 0.15,
      xlabel: plot.x_label, ylabel: plot.y_label, xLabelHeight: 18, yLabelWidth: 18,
      axes: { x: x_axis,
              y: { logscale: plot.log_y, axisLabelFormatter: tick, gridLineColor: colour("rule"), axisLineColor: colour("soft"), axisLabelWidth: 58 } },
      dateWindow: whole, valueRange: y_whole,
      legend: "never", includeZero: false, highlightSeriesOpts: null, xRangePad: plot.log_x ? 0 : 6, yRangePad: 12, labelsKMB: false,
      highlightCallback: function (event, x, points) {
        readout.textContent = plot.x_label + " " + shown(x) + ": " + points.filter(function (p) {
          return p.yval !== null && !isNaN(p.yval); }).map(function (p) { return p.name.trim() + " " + shown(p.yval); }).join("; ");
      },
      unhighlightCallback: function () { readout.textContent = ""; }
    });
    host.dygraph = g;
    tools(host, plot, g, whole, y_whole);
    keys(host, plot, g, data, readout);
  }

  // What a series looks like, for the legend.
  function swatch(s) {
    var canvas = document.createElement("canvas"), ratio = window.devicePixelRatio || 1, ctx = canvas.getContext("2d");
    canvas.width = 26 * ratio; canvas.height = 14 * ratio; canvas.style.width = "26px"; canvas.style.height = "14px";
    canvas.setAttribute("aria-hidden", "true");
    ctx.scale(ratio, ratio);
    ctx.strokeStyle = shade(s.origin, s.variant); ctx.lineWidth = 2;
    if (s.line) { ctx.setLineDash(s.dashed ? [5, 3] : pattern(s) || []); ctx.beginPath(); ctx.moveTo(1, 7); ctx.lineTo(25, 7); ctx.stroke(); }
    if (s.points) {
      ctx.setLineDash([]); ctx.lineWidth = 1.6; shape(kind_of(s), ctx, 13, 7, 4.5);
      ctx.fillStyle = hollow(s) ? colour("paper") : shade(s.origin, s.variant); ctx.fill(); ctx.stroke();
    }
    return canvas;
  }

  function tools(host, plot, g, whole, y_whole) {
    var box = host.parentNode.querySelector(".plot-tools"), groups = new Map();
    plot.series.forEach(function (s, k) {
      var name = s.group || s.name;
      if (!groups.has(name)) groups.set(name, { series: [], origin: s.origin });
      groups.get(name).series.push(k);
    });
    groups.forEach(function (group, name) {
      var label = document.createElement("label"), box_of = document.createElement("input"), text = document.createElement("span");
      box_of.type = "checkbox"; box_of.checked = true;
      box_of.addEventListener("change", function () { group.series.forEach(function (k) { g.setVisibility(k, box_of.checked); }); });
      text.className = "o-" + group.origin; text.textContent = name;
      label.append(box_of, swatch(plot.series[group.series[0]]), text); box.append(label);
    });
    var log = plot.log_y;
    function button(text, act) {
      var b = document.createElement("button"); b.type = "button"; b.textContent = text;
      b.addEventListener("click", act); box.append(b); return b;
    }
    button("Whole range", function () { g.updateOptions({ dateWindow: whole, valueRange: log === plot.log_y ? y_whole : null }); });
    var positive = plot.series.every(function (s) { return s.y.every(function (y) { return y === null || y > 0; }); });
    if (positive) {
      var b = button(log ? "Linear y" : "Logarithmic y", function () {
        log = !log; b.textContent = log ? "Linear y" : "Logarithmic y";
        g.updateOptions({ valueRange: log === plot.log_y ? y_whole : null, axes: { y: { logscale: log } } });
      });
    }
  }

  function keys(host, plot, g, data, readout) {
    var at = -1;
    host.tabIndex = 0;
    host.setAttribute("role", "application");
    host.setAttribute("aria-label", plot.title + ": interactive plot. Left and right arrows read values, plus and minus zoom, the table below lists all values.");
    host.addEventListener("keydown", function (e) {
      var range = g.xAxisRange(), middle = (range[0] + range[1]) / 2, half = (range[1] - range[0]) / 2;
      if (e.key === "ArrowRight" || e.key === "ArrowLeft") {
        at = Math.max(0, Math.min(data.rows.length - 1, at + (e.key === "ArrowRight" ? 1 : -1)));
        g.setSelection(at);
        var row = data.rows[at];
        readout.textContent = plot.x_label + " " + shown(row[0]) + ": " + plot.series.map(function (s, k) {
          var v = data.banded ? row[k + 1][1] : row[k + 1]; return shown(v) === "" ? "" : s.name + " " + shown(v);
        }).filter(Boolean).join("; ");
      } else if (e.key === "+" || e.key === "-") {
        half *= e.key === "+" ? 0.7 : 1.4; g.updateOptions({ dateWindow: [middle - half, middle + half] });
      } else return;
      e.preventDefault();
    });
  }

  document.documentElement.classList.remove("no-script");
  var plots = JSON.parse(document.getElementById("plots").textContent), drawn = [];
  document.querySelectorAll(".plot").forEach(function (host) { drawn.push([host, unpack(plots[host.dataset.plot])]); });
  // Plots are drawn when they come near the screen, so that a long report opens at once.
  var waiting = new Map(drawn);
  function now(host) {
    var p = waiting.get(host);
    if (!p || !host.clientWidth) return;  // behind a tab: when it is shown
    waiting.delete(host); draw(host, p);
  }
  if (window.IntersectionObserver) {
    var observer = new IntersectionObserver(function (seen) {
      seen.forEach(function (s) { if (s.isIntersecting) { now(s.target); if (!waiting.has(s.target)) observer.unobserve(s.target); } });
    }, { rootMargin: "600px" });
    drawn.forEach(function (d) { observer.observe(d[0]); });
  } else drawn.forEach(function (d) { now(d[0]); });
  window.rigfit_draw_all = function () { drawn.forEach(function (d) { now(d[0]); }); };

  // One state of several at a time; arrow keys go from tab to tab.
  document.querySelectorAll(".tabs").forEach(function (list) {
    var tabs = Array.from(list.children);
    function show(k) {
      tabs.forEach(function (tab, i) {
        tab.setAttribute("aria-selected", String(i === k)); tab.tabIndex = i === k ? 0 : -1;
        document.getElementById(tab.getAttribute("aria-controls")).classList.toggle("other", i !== k);
      });
      if (!window.IntersectionObserver) window.rigfit_draw_all();
    }
    tabs.forEach(function (tab, i) {
      tab.addEventListener("click", function () { show(i); });
      tab.addEventListener("keydown", function (e) {
        var step = { ArrowRight: 1, ArrowLeft: -1 }[e.key];
        if (!step) return;
        var k = (i + step + tabs.length) % tabs.length;
        show(k); tabs[k].focus(); e.preventDefault();
      });
    });
  });

  // The values of a long plot become a table when it is opened.
  var NAMES = { measured: "measured", published: "published test", "published-model": "published model", synthetic: "synthetic", modelled: "rigfit model" };
  document.querySelectorAll("details.values[data-of]").forEach(function (box) {
    box.addEventListener("toggle", function () {
      var body = box.querySelector("tbody"), plot = plots[box.dataset.of], all = 0;
      if (!box.open || body.children.length) return;
      plot.series.forEach(function (s) { all += s.x.length; });
      var every = 1 + Math.floor(all / 1000);
      plot.series.forEach(function (s) {
        for (var i = 0; i < s.x.length; i += every) {
          if (s.y[i] === null) continue;
          var row = body.insertRow(), interval = s.low && s.low[i] !== null ? shown(s.low[i]) + " to " + shown(s.high[i]) : "";
          [s.name, NAMES[s.origin], shown(s.x[i]), shown(s.y[i]), interval].forEach(function (text, c) {
            var cell = row.insertCell(); cell.textContent = text; cell.className = c === 1 ? "o-" + s.origin : c > 1 ? "n" : "";
          });
        }
      });
      if (every > 1) {
        var note = document.createElement("p"); note.className = "small";
        note.textContent = "One of " + every + " of all " + all + " values; the CSV has all."; box.append(note);
      }
    });
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", function () { location.reload(); });
})();
