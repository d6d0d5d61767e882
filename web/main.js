// Brings the page to life: figures, copy buttons, the bar.

function startCopyButtons() {
  for (const button of document.querySelectorAll('[data-copy]')) {
    button.addEventListener('click', () => copyText(button.parentElement.querySelector('code').textContent, button));
  }
}

/** Marks in the bar the section that is being read. */
function startBar() {
  const links = new Map([...document.querySelectorAll('.topbar .links a')].map((link) => [link.getAttribute('href').slice(1), link]));
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      for (const [id, link] of links) {
        if (id === entry.target.id) link.setAttribute('aria-current', 'true');
        else link.removeAttribute('aria-current');
      }
    }
  }, {rootMargin: '-15% 0px -75% 0px'});
  for (const id of links.keys()) seen.observe(document.getElementById(id));
}

/** Paper cannot unfold the study. */
function unfoldForPrint() {
  window.addEventListener('beforeprint', () => {
    for (const folded of document.querySelectorAll('details.study')) folded.open = true;
  });
}

async function start() {
  startThemeButton();
  startCopyButtons();
  startBar();
  unfoldForPrint();
  // Charts measure their texts once: the fonts must be there first.
  await Promise.all([document.fonts.load('11px Inter'), document.fonts.load('11px Inter', 'θ')]).catch(() => {});
  for (const script of document.querySelectorAll('script[type="application/json"]')) {
    startFigures(script.parentElement, JSON.parse(script.textContent));  // the figures stand beside their data
  }
  startIdleDrawing();
  document.documentElement.dataset.ready = 'true';
}

start();
