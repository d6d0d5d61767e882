// Learning curves: one panel a policy, one line a training seed, their mean with its band.

function pairs(x, v, more) {
  return x.map((step, i) => ({...more, step, value: finite(v[i])})).filter((row) => row.value !== null);
}

/** Panels of all policies on common axes, of one score; share: how much of the training they span. */
function learningPanels(score, share) {
  const policies = distinct(data.learning.map((one) => one.p));
  const panels = policies.map((policy) => {
    const all = data.learning.filter((one) => one.p === policy && one.m === score);
    const own = all.filter((one) => one.source === '');
    const runs = data.runs.filter((run) => own.some((one) => one.number === run.of));
    return {
      policy, place: placeOf(policy), yTitle: null, title: data.policies[policy].name,
      runs: runs.flatMap((run) => pairs(run.x, run.v, {seed: run.seed})),
      mean: own.flatMap((one) => one.x.map((step, i) => ({step, value: finite(one.v[i]), low: finite(one.l?.[i]), high: finite(one.h?.[i])}))),
      others: all.filter((one) => one.source !== '').flatMap((one) => pairs(one.x, one.v, {source: one.source})),
    };
  });
  const everything = panels.flatMap((panel) => [...panel.runs, ...panel.mean, ...panel.others]);
  const y = extent(everything.map((row) => row.value)) ?? [0, 1];
  const domain = {
    x: [0, share * (extent(everything.map((row) => row.step)) ?? [0, 1])[1]],
    y: y[0] >= 0 && y[1] <= 1 ? [0, 1] : padded(y),
  };
  return panels.map((panel) => ({...panel, domain}));
}

function learningRows(panels, score) {
  const row = (panel, of, one) => ({policy: data.policies[panel.policy].name, score: data.learningScores[score], of, step: one.step, value: one.value, low: one.low ?? null, high: one.high ?? null});
  return panels.flatMap((panel) => [
    ...panel.mean.map((one) => row(panel, 'mean', one)),
    ...panel.runs.map((one) => row(panel, `seed ${one.seed}`, one)),
    ...panel.others.map((one) => row(panel, one.source, one)),
  ]);
}

function describeLearning(panel, score) {
  const last = panel.mean.at(-1);
  return `${panel.title}: ${data.learningScores[score]} against training steps; ${last ? `mean ${pretty(last.value)} after ${prettyCount(last.step)} steps` : 'no mean'}`;
}

function tellLearning(panel, i) {
  const at = panel.mean[i];
  const band = at.low === null ? '' : ` [${pretty(at.low)}, ${pretty(at.high)}]`;
  const seeds = panel.runs.filter((row) => row.step === at.step).map((row) => [null, `seed ${row.seed}`, pretty(row.value)]);
  const others = panel.others.filter((row) => row.step === at.step).map((row) => [null, row.source, pretty(row.value)]);
  return [`${at.step.toLocaleString('en')} steps`, [[panel.place, 'mean', pretty(at.value) + band], ...seeds.slice(0, 10), ...others]];
}

function learningFigure(figure) {
  let [score, share] = [0, 1];
  let panels = learningPanels(score, share);
  const drawn = [];
  const show = (chosen) => {
    [score, share] = [chosen.score ?? score, chosen.share ?? share];
    panels = learningPanels(score, share);
    change({});
    for (const chart of drawn) chart.touch();
  };
  const shown = () => panels.filter((panel) => !state.hidden.has(panel.policy));
  const tiles = element('div', {class: 'tiles'});
  panels.forEach((panel, index) => {
    const host = element('div', {class: 'panel'});
    const tile = element('div', {class: 'tile', hidden: state.hidden.has(panel.policy)},
      element('h4', {}, swatch(panel.place), ` ${panel.title}`, element('small', {}, data.policies[panel.policy].kind)), host);
    tiles.append(tile);
    onChange(() => { tile.hidden = state.hidden.has(panel.policy); });
    const chart = new Chart(host, (width) => standalone(learningPanel(onScreen, {...panels[index], title: null}, width - 8, 180), panel.title),
      () => describeLearning(panels[index], score));
    drawn.push(chart);
    readable(chart, () => ({
      domain: panels[index].domain.x, log: false, tell: (i) => tellLearning(panels[index], i),
      places: panels[index].mean.map((row) => row.step).filter((step) => step <= panels[index].domain.x[1]),
    }));
  });
  const crowded = panels.some((panel) => state.hidden.has(panel.policy));
  const end = panels[0].domain.x[1];
  const spans = [[1, prettyCount(end), 'the whole training'], [0.2, prettyCount(0.2 * end), 'the first fifth']];
  const scores = distinct(data.learning.map((one) => one.m)).map((index) => [index, data.learningScores[index]]);
  const choice = (label, title, options, current, choose) => element('div', {class: 'choice'}, element('span', {class: 'label'}, label),
    segmented(title, options, current, choose));
  figure.querySelector('.body').append(
    element('p', {class: 'lead'}, 'Of the policy as trained so far, undisturbed.'),
    element('div', {class: 'choices'}, choice('Score', 'Score', scores, () => score, (to) => show({score: to})),
      choice('Steps, to', 'Steps shown', spans, () => share, (to) => show({share: to})), crowded ? policyKey(panels.map((panel) => panel.policy)) : ''), tiles);
  addTools(figure, {
    name: 'learning', rows: () => learningRows(shown(), score), commands: () => [['the study', data.runCommand]],
    spec: () => gridOfPanels(shown().map((panel) => [learningPanel(inFile, panel, 420, 200)]), `${data.name}: ${data.learningScores[score]}`),
  });
}
