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

/** The answer and the tables of margins are there once a start; the reader chooses which. */
function startChoices() {
  const parts = [...root.querySelectorAll('.by-start')];
  const startOf = (part) => Number(part.dataset.start);
  const starts = distinct(parts.map(startOf));
  const update = () => {
    const shown = starts.includes(state.start) ? state.start : starts[0];
    for (const part of parts) part.hidden = startOf(part) !== shown;
  };
  for (const place of root.querySelectorAll('.start-choices')) place.append(startChoice(starts));
  onChange(update);
  update();
}

startChoices();
for (const key of root.querySelectorAll('.key[data-policy]')) key.replaceWith(swatch(Number(key.dataset.policy)));
for (const figure of root.querySelectorAll('[data-figure]')) draw[figure.dataset.figure](figure);
