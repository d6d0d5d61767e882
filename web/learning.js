// Learning curves: one panel a policy, one line a training seed, their mean with its band.

function pairs(x, v, more) {
  return x.map((step, i) => ({...more, step, value: v[i]})).filter((row) => row.value !== null);
}

/** Panels of all policies on common axes. */
function learningPanels() {
  const policies = distinct(data.learning.map((one) => one.p));
  const panels = policies.map((policy) => {
    const all = data.learning.filter((one) => one.p === policy);
    const own = all.filter((one) => one.source === '');
    const runs = data.runs.filter((run) => own.some((one) => one.number === run.of));
    return {
      policy, yTitle: null, title: data.policies[policy].name,
      runs: runs.flatMap((run) => pairs(run.x, run.v, {seed: run.seed})),
      mean: own.flatMap((one) => one.x.map((step, i) => ({step, value: one.v[i], low: one.l?.[i] ?? null, high: one.h?.[i] ?? null}))),
      others: all.filter((one) => one.source !== '').flatMap((one) => pairs(one.x, one.v, {source: one.source})),
    };
  });
  const everything = panels.flatMap((panel) => [...panel.runs, ...panel.mean, ...panel.others]);
  const y = extent(everything.map((row) => row.value)) ?? [0, 1];
  const domain = {
    x: [0, (extent(everything.map((row) => row.step)) ?? [0, 1])[1]],
    y: y[0] >= 0 && y[1] <= 1 ? [0, 1] : padded(y),
  };
  return panels.map((panel) => ({...panel, domain}));
}

function learningRows(panels) {
  const row = (panel, of, one) => ({policy: data.policies[panel.policy].name, of, step: one.step, value: one.value, low: one.low ?? null, high: one.high ?? null});
  return panels.flatMap((panel) => [
    ...panel.mean.map((one) => row(panel, 'mean', one)),
    ...panel.runs.map((one) => row(panel, `seed ${one.seed}`, one)),
    ...panel.others.map((one) => row(panel, one.source, one)),
  ]);
}

function describeLearning(panel) {
  const last = panel.mean.at(-1);
  return `${panel.title}: ${data.learningScore} against training steps; ${last ? `mean ${pretty(last.value)} after ${pretty(last.step)} steps` : 'no mean'}`;
}

function tellLearning(panel, i) {
  const at = panel.mean[i];
  const band = at.low === null ? '' : ` [${pretty(at.low)}, ${pretty(at.high)}]`;
  const seeds = panel.runs.filter((row) => row.step === at.step).map((row) => [null, `seed ${row.seed}`, pretty(row.value)]);
  const others = panel.others.filter((row) => row.step === at.step).map((row) => [null, row.source, pretty(row.value)]);
  return [`${at.step.toLocaleString('en')} steps`, [[panel.policy, 'mean', pretty(at.value) + band], ...seeds.slice(0, 10), ...others]];
}

function learningFigure(figure) {
  const panels = learningPanels();
  const tiles = element('div', {class: 'tiles'});
  for (const panel of panels) {
    const host = element('div', {class: 'panel'});
    tiles.append(element('div', {class: 'tile'},
      element('h4', {}, swatch(panel.policy), ` ${panel.title}`, element('small', {}, data.policies[panel.policy].kind)), host));
    const chart = new Chart(host, (width) => standalone(learningPanel(onScreen, {...panel, title: null}, width - 8, 180), panel.title),
      () => describeLearning(panel));
    readable(chart, () => ({domain: panel.domain.x, log: false, places: panel.mean.map((row) => row.step), tell: (i) => tellLearning(panel, i)}));
  }
  figure.querySelector('.body').append(element('p', {class: 'lead'}, `${data.learningScore} of the policy as trained so far, undisturbed.`), tiles);
  addTools(figure, {
    name: 'learning', rows: () => learningRows(panels), commands: () => [['the study', data.runCommand]],
    spec: () => gridOfPanels(panels.map((panel) => [learningPanel(inFile, panel, 420, 200)]), `${data.name}: ${data.learningScore}`),
  });
}
