// Robustness curves, survival, and sweeps of a parameter: level against score, small multiples.

const panelHeight = 132;
const mostMarkers = 24;  // levels; beyond that markers hide the line

/** What the metric's axis spans: its natural ends, or null: each panel takes its own. */
function metricDomain(metric) {
  const {low, high} = data.metrics[metric];
  return low === null || high === null ? null : [low, high];
}

function levelDomain(sweep) {
  const [low, high] = extent(sweep.levels) ?? [0, 1];
  return low === high ? padded([low, high]) : [low, high];
}

function isLog(sweep) {
  const [low, high] = extent(sweep.levels) ?? [0, 1];
  return sweep.site === '' && low > 0 && high / low > 8;
}

function sweepTitle(sweep) {
  return sweep.name;
}

/** The levels at which a curve was measured: the sweep's, and those that its margin asked for. */
function levelsOf(curve) {
  return curve.x ?? data.sweeps[curve.s].levels;
}

/** Which of a curve's values stands nearest to a level. */
function nearest(curve, level) {
  const distances = levelsOf(curve).map((one) => Math.abs(one - level));
  return distances.indexOf(Math.min(...distances));
}

/** Rows of one sweep for the visible policies. */
function curveRows(index, metric) {
  const rows = [];
  for (const curve of curvesOf(index, state.start, metric)) {
    if (state.hidden.has(curve.p)) continue;
    levelsOf(curve).forEach((level, i) => rows.push({
      policy: data.policies[curve.p].name, level, value: finite(curve.v[i]), low: finite(curve.l?.[i]), high: finite(curve.h?.[i]),
    }));
  }
  return rows;
}

function stripRows(index) {
  if (data.saturation === undefined) return [];
  return curveRows(index, data.saturation).map(({policy, level, value}) => ({policy, level, share: value}));
}

function marginRows(index, metric) {
  if (metric !== data.marginMetric) return [];
  return data.margins
    .filter((m) => m.s === index && m.t === state.start && !m.censored && m.v !== null && !state.hidden.has(m.p))
    .map((m) => ({policy: data.policies[m.p].name, level: m.v}));
}

/** The parts of a parameter's axis where no policy can hold the plant. */
function impossibleRows(sweep) {
  const [low, high] = levelDomain(sweep);
  const [from, to] = sweep.possible.map(finite);
  return [
    ...(from !== null && from > low ? [{from: low, to: Math.min(from, high)}] : []),
    ...(to !== null && to < high ? [{from: Math.max(to, low), to: high}] : []),
  ];
}

/** The panel of a sweep for curvePanel; options: {metric, strip, title}. */
function panelOf(index, {metric, strip, title}) {
  const sweep = data.sweeps[index];
  const rows = curveRows(index, metric);
  const domain = metricDomain(metric) ?? padded(extent(rows.flatMap((row) => [row.value, row.low, row.high])) ?? [0, 1]);
  return {
    rows, strip: strip ? stripRows(index) : [], margins: sweep.site ? marginRows(index, metric) : [],
    nominal: sweep.site ? null : sweep.nominal, impossible: impossibleRows(sweep), policies: visiblePolicies(),
    x: {title: axisTitle(sweep.site ? `${sweep.site} level` : sweep.waveform, sweep.unit), domain: levelDomain(sweep), log: isLog(sweep)},
    y: {title: null, domain}, title: title ? sweepTitle(sweep) : null, markers: sweep.levels.length <= mostMarkers,
    shade: metric === data.survival ? 0.09 : 0.16,  // Wilson's intervals of few episodes are wide and overlap
  };
}

function interval(curve, i) {
  return curve.l && curve.l[i] !== null && curve.l[i] < curve.h[i] ? `${pretty(curve.v[i])} [${pretty(curve.l[i])}, ${pretty(curve.h[i])}]` : pretty(curve.v[i]);
}

/** The text that stands for a panel where it cannot be seen. */
function describePanel(index, metric) {
  const sweep = data.sweeps[index];
  const lines = curvesOf(index, state.start, metric).filter((curve) => !state.hidden.has(curve.p)).map((curve) =>
    `${data.policies[curve.p].name} from ${pretty(curve.v[0])} to ${pretty(curve.v.at(-1))}`);
  const [low, high] = levelDomain(sweep);
  return `${data.metrics[metric].title}, ${sweepTitle(sweep)}, level ${pretty(low)} to ${withUnit(pretty(high), sweep.unit)}: ${lines.join('; ')}`;
}

/** A chart of one sweep. metric() names the metric of the moment. */
function sweepChart(host, index, {metric, strip}) {
  const sweep = data.sweeps[index];
  const chart = new Chart(host, (width) => {
    const panel = panelOf(index, {metric: metric(), strip});
    return panel.rows.length > 0 ? standalone(curvePanel(onScreen, panel, width - 8, panelHeight), sweepTitle(sweep)) : null;
  }, () => describePanel(index, metric()));
  readable(chart, () => ({
    domain: levelDomain(sweep), log: isLog(sweep), places: sweep.levels,
    tell: (i) => [`${sweepTitle(sweep)}, ${withUnit(pretty(sweep.levels[i]), sweep.unit)}`, tellAt(index, metric(), i)],
  }));
  onChange(() => chart.touch());
  return chart;
}

function tellAt(index, metric, place) {
  const level = data.sweeps[index].levels[place];
  const saturated = data.saturation === undefined ? [] : curvesOf(index, state.start, data.saturation);
  return curvesOf(index, state.start, metric).filter((curve) => !state.hidden.has(curve.p)).map((curve) => {
    const i = nearest(curve, level);
    const share = saturated.find((one) => one.p === curve.p)?.v[i];
    const strip = share === null || share === undefined || metric === data.survival ? '' : ` · ${Math.round(100 * share)} % saturated`;
    return [placeOf(curve.p), data.policies[curve.p].name, interval(curve, i) + strip];
  });
}

/** Sweeps as a table: one row a waveform, one column a site; sweeps that meet in a cell go to rows of their own. */
function sweepTable(sweeps) {
  const sites = [...new Set(sweeps.map((index) => data.sweeps[index].site))];
  const rows = [];
  for (const index of sweeps) {
    const {site, waveform} = data.sweeps[index];
    let row = rows.find((one) => one.waveform === waveform && !one.cells.has(site));
    if (!row) rows.push(row = {waveform, cells: new Map()});
    row.cells.set(site, index);
  }
  return {sites, rows};
}

function figureRows(sweeps, metric) {
  return sweeps.flatMap((index) => {
    const sweep = data.sweeps[index];
    const saturated = stripRows(index);
    return curveRows(index, metric).map(({policy, level, value, low, high}) => {
      const share = saturated.find((row) => row.policy === policy && row.level === level)?.share ?? null;
      return {sweep: sweep.name, site: sweep.site, waveform: sweep.waveform, level, unit: sweep.unit, policy,
        start: data.starts[state.start].name, metric: data.metrics[metric].name, value, low, high, saturated: share};
    });
  });
}

function figureCommands(sweeps) {
  return [['the study', data.runCommand], ['all numbers', data.exportCommand],
    ...sweeps.map((index) => [sweepTitle(data.sweeps[index]), data.sweeps[index].command])];
}

/** Which of the page's values at `key` ('m' or 't') occur in the curves of these sweeps. */
function occurring(sweeps, key) {
  const wanted = new Set(sweeps);
  return distinct(data.curves.filter((curve) => wanted.has(curve.s)).map((curve) => curve[key]));
}

function glyph(waveform) {
  const paths = {
    white: 'M0 7l2-4 2 7 2-5 2 2 2-6 2 9 2-6 2 4 2-5 2 3 2-1', uniform: 'M0 5l2 4 2-6 2 3 2 3 2-7 2 4 2-2 2 5 2-3 2 2 2-4',
    step: 'M0 11H7V3H24', impulse: 'M0 11H8V2H11V11H24', sawtooth: 'M0 11L8 3V11L16 3V11L24 3', triangle: 'M0 11L4 3L12 11L20 3L24 7',
    sine: 'M0 7C3 1 5 1 8 7S13 13 16 7S21 1 24 7', constant: 'M0 4H24',
  };
  const kind = Object.keys(paths).find((name) => waveform.toLowerCase().startsWith(name));
  return kind ? svgElement('svg', {class: 'glyph', width: 24, height: 14, viewBox: '0 0 24 14', 'aria-hidden': 'true'},
    svgElement('path', {d: paths[kind]})) : '';
}

/** Sites by waveforms. options: {name, metric(), strip, choices}. */
function siteFigure(figure, {name, metric, strip, chooseMetric}) {
  const body = figure.querySelector('.body');
  const sweeps = data.sweeps.map((_, index) => index).filter((index) => data.sweeps[index].site !== '');
  const {sites, rows} = sweepTable(sweeps);
  const lines = element('div', {class: strip ? 'multiples with-strip' : 'multiples', style: `--sites:${sites.length}`},
    element('div', {class: 'corner'}), ...sites.map((site) => element('div', {class: 'column-head'}, site)));
  for (const row of rows) {
    lines.append(element('div', {class: 'row-head'}, glyph(row.waveform), element('span', {}, row.waveform)));
    for (const site of sites) {
      const index = row.cells.get(site);
      const host = element('div', {class: 'panel', 'data-site': site});
      lines.append(index === undefined ? host : element('div', {class: 'named'}, element('h4', {}, sweepTitle(data.sweeps[index])), host));
      if (index !== undefined) sweepChart(host, index, {metric, strip});
    }
  }
  body.append(choices(sweeps, chooseMetric), lines);
  addTools(figure, {
    name, rows: () => figureRows(sweeps, metric()), commands: () => figureCommands(sweeps),
    spec: () => gridOfPanels(rows.map((row) => [...row.cells.values()].map((index) =>
      curvePanel(inFile, panelOf(index, {metric: metric(), strip, title: true}), 300, 150, true))), `${data.name}: ${data.metrics[metric()].title}`),
  });
}

/** The choices above a figure of curves. */
function choices(sweeps, chooseMetric) {
  const metrics = occurring(sweeps, 'm').filter((metric) => metric !== data.saturation);
  return element('div', {class: 'choices'}, chooseMetric ? metricSelect(metrics) : '', startChoice(occurring(sweeps, 't')),
    policyKey(occurring(sweeps, 'p')));
}

/** Sweeps of a parameter, as many in a row as fit. */
function parameterFigure(figure) {
  const body = figure.querySelector('.body');
  const metric = () => state.metric;
  const sweeps = data.sweeps.map((_, index) => index).filter((index) => data.sweeps[index].site === '' &&
    data.curves.some((curve) => curve.s === index));
  const panels = element('div', {class: 'tiles'});
  for (const index of sweeps) {
    const host = element('div', {class: 'panel'});
    panels.append(element('div', {class: 'tile'}, element('h4', {}, data.sweeps[index].name), host));
    sweepChart(host, index, {metric, strip: true});
  }
  body.append(choices(sweeps, true), panels);
  addTools(figure, {
    name: 'parameters', rows: () => figureRows(sweeps, metric()), commands: () => figureCommands(sweeps),
    spec: () => gridOfPanels(sweeps.map((index) => [curvePanel(inFile, panelOf(index, {metric: metric(), strip: true, title: true}), 420, 170, true)]),
      `${data.name}: ${data.metrics[metric()].title}`),
  });
}
