// Brings the page to life: figures, copy buttons, the bar.

function startCopyButtons() {
  for (const button of document.querySelectorAll('[data-copy]')) {
    button.addEventListener('click', () => copyText(button.parentElement.querySelector('code').textContent, button));
  }
}

/** Scrolls a long bar to one of its links. */
function bringIntoBar(link) {
  const bar = link.parentElement;
  const [inner, outer] = [link.getBoundingClientRect(), bar.getBoundingClientRect()];
  if (inner.left < outer.left || inner.right > outer.right) bar.scrollLeft += inner.left - outer.left - outer.width / 3;
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
      bringIntoBar(links.get(entry.target.id));
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

/** Charts that nobody has seen are not drawn yet: a button draws all, then prints. */
function startPrintButton() {
  const button = document.getElementById('print');
  if (!button) return;
  button.hidden = false;
  const label = button.textContent;
  button.addEventListener('click', async () => {
    let drawn = 0;
    for (const chart of charts) {
      await chart.refresh();
      button.textContent = `Drawing ${++drawn} of ${charts.size}`;
    }
    button.textContent = label;
    window.print();
  });
}

/** Draws the figures of each dataset, which stand beside it. */
function startAllFigures() {
  for (const script of document.querySelectorAll('script[type="application/json"]')) {
    startFigures(script.parentElement, JSON.parse(script.textContent));
  }
  document.querySelector(':target')?.scrollIntoView({behavior: 'instant'});
}

async function start() {
  startThemeButton();
  startCopyButtons();
  startBar();
  unfoldForPrint();
  startPrintButton();
  // Charts measure their texts once: the fonts must be there first.
  await Promise.all([document.fonts.load('11px Inter'), document.fonts.load('11px Inter', 'θ')]).catch(() => {});
  startAllFigures();
  startIdleDrawing();
  document.documentElement.dataset.ready = 'true';
}

start();
