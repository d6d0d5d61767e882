// The last of startFigures(root, data): draws what the root has a place for.

const draw = {
  curves: (figure) => siteFigure(figure, {name: 'curves', metric: () => state.metric, strip: true, chooseMetric: true}),
  survival: (figure) => siteFigure(figure, {name: 'survival', metric: () => data.survival, strip: false, chooseMetric: false}),
  learning: learningFigure,
  parameters: parameterFigure,
  grids: heatFigure,
  disturbances: disturbancesFigure,
  replay: replayFigure,
};

/** The choice of start for the table of margins. */
function startMargins() {
  const tables = [...root.querySelectorAll('.margins')];
  const update = () => {
    const shown = tables.find((table) => Number(table.dataset.start) === state.start) ?? tables[0];
    for (const table of tables) table.hidden = table !== shown;
  };
  root.querySelector('#margin-choices')?.append(startChoice(tables.map((table) => Number(table.dataset.start))));
  onChange(update);
  update();
}

startMargins();
for (const key of root.querySelectorAll('.key[data-policy]')) key.replaceWith(swatch(Number(key.dataset.policy)));
for (const figure of root.querySelectorAll('[data-figure]')) draw[figure.dataset.figure](figure);
