// Draws the page's plots with dygraphs: zoom by dragging, values under the pointer or by arrow keys, series switched
// in the legend, linear or logarithmic axes. The data are in the page (script element "plots").
(function () {
  "use strict";
  var STYLE = getComputedStyle(document.documentElement);
  function colour(word) { return STYLE.getPropertyValue("--" + word).trim() || "#888"; }
  // Series of one origin differ in shade: as it is, towards the ink, towards the paper.
  function shade(s) {
    var base = colour(s.origin), other = s.shade === 1 ? colour("ink") : colour("paper");
    if (!s.shade || !/^#[0-9a-f]{6}$/i.test(base) || !/^#[0-9a-f]{6}$/i.test(other)) return base;
    var mixed = "#", share = Number(colour(s.shade === 1 ? "towards-ink" : "towards-paper"));
    for (var i = 1; i < 7; i += 2) {
      var part = Math.round(share * parseInt(base.substr(i, 2), 16) + (1 - share) * parseInt(other.substr(i, 2), 16));
      mixed += (part < 16 ? "0" : "") + part.toString(16);
    }
    return mixed;
  }
  function has_points(s) { return s.marker !== "none"; }
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
      if (s.line && !has_points(s) && s.x.some(function (x, i) { return i > 0 && x < s.x[i - 1]; })) { s.line = false; s.marker = "dot"; }
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
    var banded = plot.series.some(function (s) { return s.low && s.line && !has_points(s); });
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
        row[k + 1] = banded ? (s.low && s.line && !has_points(s) ? [s.low[i], y, s.high[i]] : [y, y, y]) : y;
        row["i" + k] = i;
      });
    });
    rows.sort(function (a, b) { return a[0] - b[0]; });
    return { rows: rows, banded: banded };
  }

  function marker(s, ctx, x, y, r) {
    ctx.beginPath();
    switch (s.marker) {
      case "square": ctx.rect(x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r); break;
      case "triangle": ctx.moveTo(x, y - 1.2 * r); ctx.lineTo(x + 1.15 * r, y + 0.8 * r); ctx.lineTo(x - 1.15 * r, y + 0.8 * r); ctx.closePath(); break;
      case "diamond": ctx.moveTo(x, y - 1.2 * r); ctx.lineTo(x + 1.2 * r, y); ctx.lineTo(x, y + 1.2 * r); ctx.lineTo(x - 1.2 * r, y); ctx.closePath(); break;
      case "plus": ctx.moveTo(x - 1.5 * r, y); ctx.lineTo(x + 1.5 * r, y); ctx.moveTo(x, y - 1.5 * r); ctx.lineTo(x, y + 1.5 * r); break;
      case "cross": ctx.moveTo(x - r, y - r); ctx.lineTo(x + r, y + r); ctx.moveTo(x - r, y + r); ctx.lineTo(x + r, y - r); break;
      case "dot": ctx.arc(x, y, s.shade ? 1.3 : 2.2, 0, 2 * Math.PI); break;
      default: ctx.arc(x, y, r, 0, 2 * Math.PI);
    }
    ctx.lineWidth = s.marker === "plus" || s.marker === "cross" ? 2 : 1.6;
    ctx.strokeStyle = shade(s); ctx.fillStyle = s.hollow ? colour("paper") : shade(s);
    ctx.fill();
    if (s.marker !== "dot") ctx.stroke();
  }
  function pattern(s) { return s.dash.length ? s.dash : null; }
  // The same plot with its ordinate in dB against one unit.
  function in_decibels(plot) {
    function db(v) { return v === null || v === undefined || !(v > 0) ? null : 20 * Math.log10(v); }
    return Object.assign({}, plot, { log_y: false, y_label: plot.y_label.replace(/^(\|H\|)(, )?(.*)$/, "$1, dB re 1 $3"), series: plot.series.map(function (s) {
      return Object.assign({}, s, { y: s.y.map(db), low: s.low && s.low.map(db), high: s.high && s.high.map(db) });
    }) });
  }

  // All points with their bars and bands.
  function y_range(plot) {
    var low = Infinity, high = -Infinity, log = plot.log_y;
    function take(v) {
      if (v === null || v === undefined || isNaN(v) || (log && v <= 0)) return;
      var at = log ? Math.log(v) : v;
      low = Math.min(low, at); high = Math.max(high, at);
    }
    plot.series.forEach(function (s) {
      s.y.forEach(take);
      if (s.low) { s.low.forEach(take); s.high.forEach(take); }
    });
    if (!(low <= high)) return null;
    var margin = 0.05 * (high - low) || 0.1 * Math.abs(high) || 1;
    return log ? [Math.exp(low - margin), Math.exp(high + margin)] : [low - margin, high + margin];
  }

  // Ticks at decades, with faint lines between; at 2 and 5, or at whole steps, where there are few decades.
  function decade_ticks(from, to) {
    var ticks = [], decades = Math.log10(to / from);
    if (!(decades > 0)) return ticks;
    if (decades < 0.7) {
      var rough = (to - from) / 5, power = Math.pow(10, Math.floor(Math.log10(rough))), lead = rough / power;
      var step = power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
      for (var k = Math.ceil(from / step); k * step <= to; ++k) ticks.push({ v: k * step, label: tick(k * step) });
      return ticks;
    }
    var every = Math.max(1, Math.ceil(decades / 8)), named = decades < 1.5 ? [1, 2, 3, 5, 7] : decades < 3 ? [1, 2, 5] : [1];
    for (var e = Math.floor(Math.log10(from)); e <= Math.log10(to); ++e) {
      for (var m = 1; m < 10; ++m) {
        var v = m * Math.pow(10, e);
        if (v < from || v > to || (m > 1 && decades > 6)) continue;
        var label = named.indexOf(m) >= 0 && e % every === 0;
        ticks.push({ v: v, label: label ? tick(v) : "" });
      }
    }
    return ticks;
  }
  // Parts of a turn.
  function angle_ticks(from, to) {
    var step = 30, ticks = [];
    [45, 90, 180, 360, 720, 1800, 3600, 18000].forEach(function (next) { if ((to - from) / step > 6) step = next; });
    for (var k = Math.ceil(from / step); k * step <= to; ++k) ticks.push({ v: k * step, label: String(k * step) });
    return ticks;
  }

  // Ticks of an axis that counts.
  function whole_numbers(from, to) {
    var ticks = [];
    for (var v = Math.ceil(from); v <= to; ++v) ticks.push({ v: v, label: String(v) });
    return ticks;
  }

  // Plots that share their abscissa: zoom and cursor go to all that are drawn.
  var families = new Map();
  function family_of(plot) {
    if (!plot.link) return [];
    if (!families.has(plot.link)) families.set(plot.link, []);
    return families.get(plot.link);
  }
  function move_cursor(host, g, x) {
    var line = host.querySelector(".cursor");
    if (!line) { line = document.createElement("div"); line.className = "cursor"; host.append(line); }
    line.style.display = x === null ? "none" : "block";
    if (x !== null) line.style.left = g.toDomXCoord(x) + "px";
  }
  function read_all(host, plot, x) {
    var list = plot.link ? family_of(plot) : [{ host: host, g: host.dygraph, plot: plot }];
    list.forEach(function (one) {
      move_cursor(one.host, one.g, x);
      if (one.host !== host) one.host.parentNode.querySelector(".readout").textContent = x === null ? "" : values_at(one.plot, x);
    });
  }
  // Values of all series at the abscissa nearest to x.
  function values_at(plot, x) {
    return plot.x_label + " " + shown(x) + ": " + plot.series.map(function (s) {
      if (!s.line || s.x.length < 2) return "";
      var a = 0, b = s.x.length - 1;
      while (b - a > 1) { var m = (a + b) >> 1; if (s.x[m] <= x) a = m; else b = m; }
      var i = x - s.x[a] < s.x[b] - x ? a : b;
      return s.y[i] === null || isNaN(s.y[i]) ? "" : s.name + " " + shown(s.y[i]);
    }).filter(Boolean).join("; ");
  }
  function draw_marks(plot, ctx, area, g) {
    var last = -Infinity;
    ctx.save(); ctx.font = "11px sans-serif"; ctx.textAlign = "center";
    plot.marks.forEach(function (mark) {
      var x = Math.round(g.toDomXCoord(mark.x)) + 0.5;
      if (x < area.x || x > area.x + area.w) return;
      ctx.strokeStyle = ctx.fillStyle = colour(mark.origin); ctx.globalAlpha = 0.6;
      ctx.setLineDash(mark.doubtful ? [3, 3] : []);
      ctx.beginPath(); ctx.moveTo(x, area.y); ctx.lineTo(x, area.y + area.h); ctx.stroke();
      ctx.globalAlpha = 1;
      var half = ctx.measureText(mark.label).width / 2;
      if (x - half < last) return;
      last = x + half + 4;
      var at = Math.min(Math.max(x, area.x + half), area.x + area.w - half), ink = ctx.fillStyle;
      ctx.fillStyle = colour("paper"); ctx.fillRect(at - half - 2, area.y, 2 * half + 4, 14);
      ctx.fillStyle = ink; ctx.fillText(mark.label, at, area.y + 11);
    });
    ctx.restore();
  }

  function draw(host, plot) {
    var data = table(plot);
    var labels = ["x"], options = {};
    var overlaid = plot.series.some(function (s) { return s.line && s.origin === "modelled"; });
    plot.series.forEach(function (s, k) {
      var name = s.name;
      while (labels.indexOf(name) >= 0) name += " ";
      labels.push(name);
      var line_colour = shade(s);
      options[name] = {
        color: line_colour,
        connectSeparatedPoints: true,
        // A test that a model lies on is seen beneath it.
        strokeWidth: !s.line ? 0 : overlaid && s.origin !== "modelled" && s.shade !== 2 ? 3.2 : s.x.length > 700 ? 1.3 : 1.8,
        strokePattern: pattern(s),
        drawPoints: has_points(s), pointSize: has_points(s) ? 4.5 : 1, highlightCircleSize: 6,
        drawPointCallback: function (g, series, ctx, x, y, c, size, idx) {
          ctx.save();
          ctx.strokeStyle = line_colour; ctx.lineWidth = 1.6;
          if (s.low) {
            var i = data.rows[idx]["i" + k], low = s.low[i], high = s.high[i];
            if (low !== null && high !== null) {
              var a = g.toDomYCoord(low), b = g.toDomYCoord(high);
              ctx.beginPath(); ctx.moveTo(x, a); ctx.lineTo(x, b); ctx.moveTo(x - 4, a); ctx.lineTo(x + 4, a); ctx.moveTo(x - 4, b); ctx.lineTo(x + 4, b); ctx.stroke();
            }
          }
          marker(s, ctx, x, y, size);
          ctx.restore();
        }
      };
    });
    var xs = data.rows.map(function (r) { return r[0]; });
    var low = Math.min.apply(null, xs), high = Math.max.apply(null, xs), margin = 0.04 * (high - low || 1);
    // dygraphs pads a logarithmic abscissa below zero: its range is said.
    var whole = plot.log_x ? [low / Math.pow(high / low, 0.03), high * Math.pow(high / low, 0.03)] : [low - margin, high + margin];
    var readout = host.parentNode.querySelector(".readout"), y_whole = y_range(plot);
    if (plot.same_axes && y_whole) {  // as high as wide
      y_whole = whole = [Math.min(whole[0], y_whole[0]), Math.max(whole[1], y_whole[1])];
      host.style.maxWidth = (host.clientHeight + 40) + "px";
    }
    var counted = !plot.log_x && high - low <= 20 && xs.every(function (x) { return Number.isInteger(x); });
    var x_axis = { logscale: plot.log_x, axisLabelFormatter: tick, gridLineColor: colour("rule"), axisLineColor: colour("soft") };
    if (counted) x_axis.ticker = whole_numbers;
    if (plot.log_x) x_axis.ticker = decade_ticks;
    var y_axis = { logscale: plot.log_y, axisLabelFormatter: tick, gridLineColor: colour("rule"), axisLineColor: colour("soft"), axisLabelWidth: 58 };
    if (plot.angle) y_axis.ticker = angle_ticks;
    else if (plot.log_y) y_axis.ticker = decade_ticks;
    var family = family_of(plot);
    if (family.length) whole = family[0].whole;
    var g = new Dygraph(host, data.rows, {
      labels: labels, series: options, customBars: data.banded, fillAlpha: 0.15,
      xlabel: plot.x_label, ylabel: plot.y_label, xLabelHeight: 18, yLabelWidth: 18,
      axes: { x: x_axis, y: y_axis },
      dateWindow: family.length ? family[0].g.xAxisRange() : whole, valueRange: y_whole,
      underlayCallback: function (ctx, area, graph) { draw_marks(plot, ctx, area, graph); },
      drawCallback: function (graph, first) {
        if (first) return;
        var range = graph.xAxisRange();
        family.forEach(function (one) {
          var theirs = one.g.xAxisRange();
          if (one.g === graph || (theirs[0] === range[0] && theirs[1] === range[1])) return;
          one.g.updateOptions({ dateWindow: range });
        });
      },
      legend: "never", includeZero: false, highlightSeriesOpts: null, xRangePad: plot.log_x ? 0 : 6, yRangePad: 12, labelsKMB: false,
      highlightCallback: function (event, x, points) {
        readout.textContent = plot.x_label + " " + shown(x) + ": " + points.filter(function (p) {
          return p.yval !== null && !isNaN(p.yval); }).map(function (p) { return p.name.trim() + " " + shown(p.yval); }).join("; ");
        read_all(host, plot, x);
      },
      unhighlightCallback: function () { readout.textContent = ""; read_all(host, plot, null); }
    });
    host.dygraph = g;
    family.push({ host: host, g: g, plot: plot, whole: whole });
    tools(host, plot, g, whole, y_whole);
    keys(host, plot, g, data, readout);
  }

  // What a series looks like, for the legend.
  function swatch(s) {
    var canvas = document.createElement("canvas"), ratio = window.devicePixelRatio || 1, ctx = canvas.getContext("2d");
    canvas.width = 26 * ratio; canvas.height = 14 * ratio; canvas.style.width = "26px"; canvas.style.height = "14px";
    canvas.setAttribute("aria-hidden", "true");
    ctx.scale(ratio, ratio);
    ctx.strokeStyle = shade(s); ctx.lineWidth = 2;
    if (s.line) { ctx.setLineDash(s.dash); ctx.beginPath(); ctx.moveTo(1, 7); ctx.lineTo(25, 7); ctx.stroke(); }
    ctx.setLineDash([]);
    if (s.marker === "dot") [6, 13, 20].forEach(function (x) { marker(s, ctx, x, 7, 2); });
    else if (has_points(s)) marker(s, ctx, 13, 7, 4.5);
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
    if (positive && !plot.decibels) {
      var b = button(log ? "Linear y" : "Logarithmic y", function () {
        log = !log; b.textContent = log ? "Linear y" : "Logarithmic y";
        g.updateOptions({ valueRange: log === plot.log_y ? y_whole : null, axes: { y: { logscale: log, ticker: log ? decade_ticks : Dygraph.numericTicks } } });
      });
    }
    if (plot.decibels) {
      var other = in_decibels(plot), shows_db = false;
      var d = button("dB", function () {
        shows_db = !shows_db; d.textContent = shows_db ? plot.y_label : "dB";
        var now = shows_db ? other : plot, range = y_range(now);
        g.updateOptions({ file: table(now).rows, ylabel: now.y_label, valueRange: range,
                          axes: { y: { logscale: now.log_y, ticker: now.log_y ? decade_ticks : Dygraph.numericTicks } } });
        y_whole = range; log = plot.log_y;
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
