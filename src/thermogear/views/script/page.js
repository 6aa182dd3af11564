// --- the page ---------------------------------------------------------------------------------

const start = (host) => {
  if (host.dataset.gears) {
    const live = element("div", null, {class: "live"});
    host.before(live);
    drawGears(live, JSON.parse(host.dataset.gears));
    host.closest("figure").classList.add("moves", "turns");
  } else figures.push(new Figure(host, whole(host.dataset.picture)));
};
const figures = [];
const sight = new IntersectionObserver((seen) => {
  for (const one of seen) if (one.isIntersecting) {
    sight.unobserve(one.target);
    start(one.target);
  }
}, {rootMargin: "400px"});
for (const one of document.querySelectorAll("[data-picture],[data-gears]")) sight.observe(one);
dark.addEventListener("change", () => {
  found = {};
  figures.forEach((one) => one.recolour());
});
const unfold = () => {
  const target = document.getElementById(location.hash.slice(1));
  if (!target) return;
  for (let fold = target.closest("details"); fold; fold = fold.parentElement.closest("details"))
    fold.open = true;
  if (target.tagName === "DETAILS") target.open = true;
  else for (const fold of target.querySelectorAll(":scope > details")) fold.open = true;
  target.scrollIntoView();
};
addEventListener("hashchange", unfold);
if (location.hash.length > 1) unfold();
