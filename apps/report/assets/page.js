// The page around the blocks: menu, where one is, links into what is folded, search.
(function () {
  "use strict";
  var side = document.querySelector(".side"), menu = side.querySelector(".menu");
  function open_menu(open) { side.classList.toggle("open", open); menu.setAttribute("aria-expanded", String(open)); }
  menu.addEventListener("click", function () { open_menu(!side.classList.contains("open")); });
  addEventListener("keydown", function (e) { if (e.key === "Escape" && side.classList.contains("open")) { open_menu(false); menu.focus(); } });
  side.addEventListener("click", function (e) { if (e.target.closest("a")) open_menu(false); });

  // Opens every fold and tab around an element, then shows it.
  function reveal(element) {
    for (var e = element; e; e = e.parentElement) {
      if (e.tagName === "DETAILS") e.open = true;
      if (e.classList.contains("panel") && e.classList.contains("other")) document.getElementById(e.getAttribute("aria-labelledby")).click();
    }
    element.scrollIntoView({ block: element.offsetHeight > innerHeight / 2 ? "start" : "center" });
  }
  function from_hash() {
    var id = decodeURIComponent(location.hash.slice(1)), element = id && document.getElementById(id);
    if (element && (element.closest("details:not([open])") || element.closest(".panel.other"))) reveal(element);
  }
  addEventListener("hashchange", from_hash);
  from_hash();

  // The section that is read is marked in the list.
  var links = new Map();
  side.querySelectorAll("ol a[href^='#']").forEach(function (a) { links.set(a.hash.slice(1), a); });
  if (window.IntersectionObserver) {
    var current = null, seen = new IntersectionObserver(function (entries) {
      entries.forEach(function (entry) {
        var link = entry.isIntersecting && links.get(entry.target.getAttribute("aria-labelledby"));
        if (!link || link === current) return;
        if (current) current.removeAttribute("aria-current");
        link.setAttribute("aria-current", "true"); current = link;
      });
    }, { rootMargin: "-15% 0px -75% 0px" });
    document.querySelectorAll("main > section[aria-labelledby]").forEach(function (s) { seen.observe(s); });
  }

  // Search: headings, captions, remarks, table rows and answers that hold every word.
  var input = document.getElementById("search"), found = document.getElementById("found"), index = null;
  function words_of(element) { return element.textContent.replace(/\s+/g, " ").trim(); }
  function build() {
    index = [];
    document.querySelectorAll("main h1, main h2, main h3, main h4, main h5, main figcaption, main caption, main p, main li, main tbody tr, main button[role=tab]").forEach(function (e) {
      if (e.closest(".contents")) return;
      var text = e.tagName === "TR" ? Array.from(e.cells).map(words_of).filter(Boolean).join(", ") : words_of(e);
      if (text) index.push({ element: e, text: text, low: text.toLowerCase(), rank: /^H/.test(e.tagName) ? 0 : 1 });
    });
  }
  function place_of(element) {
    var section = element.closest("main > section"), heading = section && section.querySelector("h1, h2");
    return heading ? words_of(heading) : "";
  }
  function search() {
    var words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    found.textContent = "";
    if (!words.length || words.join("").length < 2) return;
    if (!index) build();
    var hits = index.filter(function (one) { return words.every(function (w) { return one.low.indexOf(w) >= 0; }); });
    hits.sort(function (a, b) { return a.rank - b.rank; });
    hits.slice(0, 20).forEach(function (hit) {
      var item = document.createElement("li"), a = document.createElement("a"), where = document.createElement("small");
      var at = Math.max(0, hit.low.indexOf(words[0]) - 30);
      a.href = "#" + ((hit.element.closest("[id]") || {}).id || "main");
      a.textContent = (at > 0 ? "…" : "") + hit.text.substr(at, 90);
      where.textContent = place_of(hit.element); a.append(where); item.append(a); found.append(item);
      a.addEventListener("click", function (e) {
        e.preventDefault(); history.replaceState(null, "", a.href); reveal(hit.element);
        hit.element.classList.add("found-here"); setTimeout(function () { hit.element.classList.remove("found-here"); }, 2500);
      });
    });
    if (!hits.length || hits.length > 20) {
      var rest = document.createElement("li"); rest.className = "none";
      rest.textContent = hits.length ? hits.length - 20 + " more" : "nothing found"; found.append(rest);
    }
  }
  input.addEventListener("input", search);
  addEventListener("keydown", function (e) {
    if (e.key !== "/" || /^(INPUT|SELECT|TEXTAREA)$/.test(document.activeElement.tagName)) return;
    open_menu(true); input.focus(); e.preventDefault();
  });
})();
