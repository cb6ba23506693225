// Mode shapes in space, moving: parallel projection, turned by dragging or arrow keys. Coloured by family.
(function () {
  "use strict";
  function viewer(host) {
    var data = JSON.parse(document.getElementById(host.dataset.shapes).textContent);
    var canvas = host.querySelector("canvas"), ctx = canvas.getContext("2d");
    var state_list = host.querySelector(".state"), mode_list = host.querySelector(".mode"), play = host.querySelector(".play");
    var yaw = -0.55, pitch = 0.35, phase = 0, last = 0;
    var playing = !matchMedia("(prefers-reduced-motion: reduce)").matches, visible = false, state, mode, box;
    data.forEach(function (s, i) { state_list.add(new Option(s.label, i)); });
    function pick_state() {
      state = data[state_list.value];
      var keep = mode_list.selectedIndex;
      mode_list.length = 0;
      state.modes.forEach(function (m, i) { mode_list.add(new Option(m.label + ": " + m.frequency_hz.toPrecision(4) + " Hz (" + m.family + ")", i)); });
      mode_list.selectedIndex = Math.max(0, Math.min(keep, state.modes.length - 1));
      pick_mode();
    }
    function pick_mode() {
      mode = state.modes[mode_list.value];
      var low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
      mode.members.forEach(function (m) { m.rest.forEach(function (p) { for (var k = 0; k < 3; ++k) { low[k] = Math.min(low[k], p[k]); high[k] = Math.max(high[k], p[k]); } }); });
      box = { centre: low.map(function (l, k) { return (l + high[k]) / 2; }), size: Math.max(high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-6),
              wide: Math.hypot(high[0] - low[0], high[2] - low[2]), tall: high[1] - low[1] };
      canvas.setAttribute("aria-label", "Moving mode shape, " + state.label + ", " + mode_list.options[mode_list.selectedIndex].text + "; arrow keys turn it");
      draw();
    }
    function project(p) {
      var x = p[0] - box.centre[0], y = p[1] - box.centre[1], z = p[2] - box.centre[2];
      var cy = Math.cos(yaw), sy = Math.sin(yaw), cp = Math.cos(pitch), sp = Math.sin(pitch);
      var u = cy * x + sy * z, depth = -sy * x + cy * z, v = cp * y - sp * depth;
      // Room for the motion, and for what turning brings into view.
      var scale = 0.92 * Math.min(canvas.width / (box.wide + 0.25 * box.size), canvas.height / (box.tall + 0.3 * box.wide + 0.25 * box.size));
      return [canvas.width / 2 + scale * u, canvas.height / 2 - scale * v];
    }
    function path(points) {
      ctx.beginPath();
      points.forEach(function (p, i) { var q = project(p); if (i) ctx.lineTo(q[0], q[1]); else ctx.moveTo(q[0], q[1]); });
      ctx.stroke();
    }
    function draw() {
      if (!mode) return;
      var style = getComputedStyle(document.documentElement), ratio = window.devicePixelRatio || 1;
      var w = Math.round(canvas.clientWidth * ratio), h = Math.round(canvas.clientHeight * ratio);
      if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
      ctx.clearRect(0, 0, w, h);
      ctx.lineJoin = ctx.lineCap = "round";
      var amplitude = 0.11 * box.size * Math.cos(phase);
      mode.members.forEach(function (m) {
        ctx.strokeStyle = style.getPropertyValue("--soft"); ctx.lineWidth = 1 * ratio; ctx.setLineDash([4 * ratio, 4 * ratio]);
        path(m.rest);
        ctx.setLineDash([]); ctx.strokeStyle = style.getPropertyValue("--" + mode.family); ctx.lineWidth = 3 * ratio;
        path(m.rest.map(function (p, i) { return [0, 1, 2].map(function (k) { return p[k] + amplitude * m.shape[i][k]; }); }));
      });
      var o = [40 * ratio, h - 40 * ratio], length = 28 * ratio, saved = box;
      box = { centre: [0, 0, 0], size: 1, wide: 1, tall: 1 };
      ctx.fillStyle = ctx.strokeStyle = style.getPropertyValue("--soft"); ctx.lineWidth = ratio; ctx.font = 12 * ratio + "px sans-serif";
      [["x", [1, 0, 0]], ["y", [0, 1, 0]], ["z", [0, 0, 1]]].forEach(function (a) {
        var c = project([0, 0, 0]), q = project(a[1]), s = 0.92 * Math.min(w / 1.25, h / 1.55);
        var dx = (q[0] - c[0]) / s * length, dy = (q[1] - c[1]) / s * length;
        ctx.beginPath(); ctx.moveTo(o[0], o[1]); ctx.lineTo(o[0] + dx, o[1] + dy); ctx.stroke(); ctx.fillText(a[0], o[0] + 1.25 * dx - 3, o[1] + 1.25 * dy + 4);
      });
      box = saved;
    }
    function frame(t) {
      if (playing && visible) { phase += Math.min(0.1, (t - last) / 1000) * 2 * Math.PI * 0.8; draw(); }
      last = t; requestAnimationFrame(frame);
    }
    function label() { play.textContent = playing ? "Pause" : "Move"; }
    state_list.addEventListener("change", pick_state); mode_list.addEventListener("change", pick_mode);
    play.addEventListener("click", function () { playing = !playing; label(); });
    var from = null;
    canvas.addEventListener("pointerdown", function (e) { from = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener("pointermove", function (e) {
      if (!from) return;
      yaw += 0.01 * (e.clientX - from[0]); pitch = Math.max(-1.5, Math.min(1.5, pitch + 0.01 * (e.clientY - from[1])));
      from = [e.clientX, e.clientY]; draw();
    });
    canvas.addEventListener("pointerup", function () { from = null; });
    canvas.addEventListener("keydown", function (e) {
      var turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[e.key];
      if (!turn) return;
      yaw += turn[0]; pitch = Math.max(-1.5, Math.min(1.5, pitch + turn[1])); draw(); e.preventDefault();
    });
    if (window.IntersectionObserver) new IntersectionObserver(function (seen) { visible = seen[seen.length - 1].isIntersecting; }).observe(canvas);
    else visible = true;
    host.rigfit_phase = function () { return phase; };
    label(); pick_state(); requestAnimationFrame(frame);
    addEventListener("resize", draw);
  }
  document.querySelectorAll(".shapes").forEach(viewer);
})();
