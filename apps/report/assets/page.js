// The page around the blocks: menu, links into what is folded.
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
})();
