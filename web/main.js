// Brings the page to life: figures, the choice of start for the margins, copy buttons, the bar.

const figures = {
  curves: (figure) => siteFigure(figure, {name: 'curves', metric: () => state.metric, strip: true, chooseMetric: true}),
  survival: (figure) => siteFigure(figure, {name: 'survival', metric: () => data.survival, strip: false, chooseMetric: false}),
  learning: learningFigure,
  parameters: parameterFigure,
  grids: heatFigure,
  replay: replayFigure,
};

function startMargins() {
  const tables = [...document.querySelectorAll('.margins')];
  const update = () => {
    const shown = tables.find((table) => Number(table.dataset.start) === state.start) ?? tables[0];
    for (const table of tables) table.hidden = table !== shown;
  };
  document.getElementById('margin-choices')?.append(startChoice(tables.map((table) => Number(table.dataset.start))));
  onChange(update);
  update();
}

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
  startMargins();
  startCopyButtons();
  startBar();
  unfoldForPrint();
  for (const key of document.querySelectorAll('.key[data-policy]')) key.replaceWith(swatch(Number(key.dataset.policy)));
  // Charts measure their texts once: the fonts must be there first.
  await Promise.all([document.fonts.load('11px Inter'), document.fonts.load('11px Inter', 'θ')]).catch(() => {});
  for (const [id, draw] of Object.entries(figures)) {
    const figure = document.getElementById(`figure-${id}`);
    if (figure) draw(figure);
  }
  startIdleDrawing();
  document.documentElement.dataset.ready = 'true';
}

start();
