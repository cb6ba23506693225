// Figures on a screen: drag or arrow keys zoom the abscissa, a double click or Escape shows the whole again, the pointer
// reads values, entries of the legend switch series. Figures with one link go together. And tabs.
(function () {
  "use strict";
  document.documentElement.classList.remove("no-script");
  var NS = "http://www.w3.org/2000/svg", families = {};
  function box_of(svg) { return ["x", "y", "width", "height"].map(function (a) { return Number(svg.getAttribute(a)); }); }
  function axis(text) { var p = text.split(" ").map(Number); return { low: p[0], high: p[1], log: p[2] === 1 }; }
  function value(a, t) { return a.log ? a.low * Math.pow(a.high / a.low, t) : a.low + t * (a.high - a.low); }
  function place(a, v) { return a.log ? Math.log(v / a.low) / Math.log(a.high / a.low) : (v - a.low) / (a.high - a.low); }
  function shown(v, digits) { return String(Number(v.toPrecision(digits))).replace("-", "−"); }
  function ticks(a) {
    var list = [], decades = Math.log10(a.high / a.low), v;
    if (a.log && decades > 0.7) {
      for (var e = Math.floor(Math.log10(a.low)); e <= Math.log10(a.high); ++e)
        (decades < 1.5 ? [1, 2, 3, 5, 7] : decades < 3 ? [1, 2, 5] : [1]).forEach(function (m) {
          v = m * Math.pow(10, e); if (v >= a.low && v <= a.high) list.push(v);
        });
      return list;
    }
    var rough = (a.high - a.low) / 5, power = Math.pow(10, Math.floor(Math.log10(rough))), lead = rough / power;
    var step = power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
    for (var k = Math.ceil(a.low / step); k * step <= a.high; ++k) list.push(k * step);
    return list;
  }
  function make(name, attributes, parent) {
    var e = document.createElementNS(NS, name);
    Object.keys(attributes).forEach(function (k) { e.setAttribute(k, attributes[k]); });
    parent.append(e); return e;
  }

  function figure(svg) {
    var inner = svg.querySelector(".in"), b = box_of(inner), x = axis(svg.dataset.x), y = axis(svg.dataset.y);
    var now = x, from = null, readout = svg.closest("figure").querySelector(".readout");
    var drawn = svg.querySelector(".ticks"), labels = svg.querySelectorAll("text.at"), first = drawn.innerHTML;
    var places = Array.from(labels, function (t) { return Number(t.getAttribute("x")); });
    var cursor = make("path", { "class": "cursor", d: "" }, svg), one = { svg: svg, zoom: zoom, read: read };
    (families[svg.dataset.link || svg.closest("figure").id] = families[svg.dataset.link || svg.closest("figure").id] || []).push(one);
    function family() { return families[svg.dataset.link || svg.closest("figure").id]; }
    // The abscissa from low to high; the ordinate stays.
    function zoom(low, high) {
      now = low === undefined ? x : { low: Math.max(low, x.low), high: Math.min(high, x.high), log: x.log };
      var a = b[0] + b[2] * place(x, now.low), w = b[2] * (place(x, now.high) - place(x, now.low)), scale = w / b[2];
      inner.setAttribute("viewBox", [a, b[1], w, b[3]].join(" "));
      inner.querySelectorAll(".m").forEach(function (m) {
        m.setAttribute("transform", m.getAttribute("transform").replace(/ scale.*/, "") + (scale < 1 ? " scale(" + scale + " 1)" : ""));
      });
      labels.forEach(function (t, i) {
        var at = b[0] + (places[i] - a) / scale;
        t.setAttribute("x", at); t.style.display = at < b[0] || at > b[0] + b[2] ? "none" : "";
      });
      if (now.low === x.low && now.high === x.high) { drawn.innerHTML = first; return; }
      drawn.textContent = "";
      ticks(now).forEach(function (v) {
        var at = b[0] + b[2] * place(now, v);
        make("path", { "class": "grid", d: "M" + at + " " + (b[1] + b[3]) + "V" + b[1] }, drawn);
        make("text", { "class": "t", x: at, y: b[1] + b[3] + 17, "text-anchor": "middle" }, drawn).textContent = shown(v, 6);
      });
    }
    function read(v) {
      var at = v === null ? NaN : b[0] + b[2] * place(now, v);
      cursor.setAttribute("d", at >= b[0] && at <= b[0] + b[2] ? "M" + at + " " + b[1] + "v" + b[3] : "");
    }
    function all(what, p, q) { family().forEach(function (other) { other[what](p, q); }); }
    // The pointer as shares of the axes.
    function shares(e) {
      var r = svg.getBoundingClientRect(), k = svg.viewBox.baseVal.width / r.width;
      return [((e.clientX - r.left) * k - b[0]) / b[2], 1 - ((e.clientY - r.top) * k - b[1]) / b[3]];
    }
    svg.addEventListener("pointermove", function (e) {
      var s = shares(e), inside = s[0] >= 0 && s[0] <= 1 && s[1] >= 0 && s[1] <= 1;
      all("read", inside ? value(now, s[0]) : null);
      readout.textContent = inside ? shown(value(now, s[0]), 5) + "; " + shown(value(y, s[1]), 4) : "";
    });
    svg.addEventListener("pointerleave", function () { all("read", null); readout.textContent = ""; });
    svg.addEventListener("pointerdown", function (e) { if (e.pointerType === "mouse") { from = shares(e)[0]; e.preventDefault(); svg.focus(); } });
    svg.addEventListener("pointerup", function (e) {
      var to = shares(e)[0], start = from; from = null;
      if (start === null || Math.abs(to - start) < 0.02) return;
      all("zoom", value(now, Math.min(start, to)), value(now, Math.max(start, to)));
    });
    svg.addEventListener("dblclick", function () { all("zoom"); });
    svg.addEventListener("keydown", function (e) {
      var t = { ArrowLeft: [-0.2, 0.8], ArrowRight: [0.2, 1.2], "+": [0.2, 0.8], "-": [-0.35, 1.35] }[e.key];
      if (e.key === "Escape") all("zoom");
      else if (t) { all("zoom", value(now, t[0]), value(now, t[1])); e.preventDefault(); }
      if (t) readout.textContent = shown(now.low, 5) + " to " + shown(now.high, 5);
    });
    svg.querySelectorAll(".lg").forEach(function (key) {
      key.setAttribute("role", "checkbox"); key.setAttribute("tabindex", "0"); key.setAttribute("aria-checked", "true");
      key.setAttribute("aria-label", key.dataset.k);
      function toggle() {
        var off = key.classList.toggle("off"); key.setAttribute("aria-checked", String(!off));
        inner.querySelectorAll("[data-k]").forEach(function (g) { if (g.dataset.k === key.dataset.k) g.style.display = off ? "none" : ""; });
      }
      key.addEventListener("click", toggle);
      key.addEventListener("keydown", function (e) { if (e.key === "Enter" || e.key === " ") { toggle(); e.preventDefault(); e.stopPropagation(); } });
    });
    svg.setAttribute("tabindex", "0"); svg.setAttribute("role", "application");
    svg.setAttribute("aria-label", svg.querySelector("title").textContent + ": arrow keys, + and - zoom, Escape shows all");
  }
  document.querySelectorAll("svg.fig").forEach(figure);

  addEventListener("beforeprint", function () { document.querySelectorAll("details.fold").forEach(function (d) { d.open = true; }); });

  // One state of several at a time; arrow keys go from tab to tab.
  document.querySelectorAll(".tabs").forEach(function (list) {
    var tabs = Array.from(list.children);
    function show(k) {
      tabs.forEach(function (tab, i) {
        tab.setAttribute("aria-selected", String(i === k)); tab.tabIndex = i === k ? 0 : -1;
        document.getElementById(tab.getAttribute("aria-controls")).classList.toggle("other", i !== k);
      });
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
})();
