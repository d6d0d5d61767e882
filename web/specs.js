// Vega-Lite specifications. All data are inline and all fields have our own names: a name from the study is only ever data.

const schema = 'https://vega.github.io/schema/vega-lite/v6.json';
const yAxisWidth = 36;
const rightAir = 8;

function quantitative(field, {title = null, domain = null, log = false, axis = {}}) {
  const scale = log ? {type: 'log', nice: false} : {zero: false, nice: false};
  if (domain) scale.domain = domain;
  return {field, type: 'quantitative', title, scale, axis};
}

function xAxis(width) {
  return {tickCount: Math.max(3, Math.floor(width / 60)), grid: false, labelFlush: true, labelOverlap: 'greedy', labelSeparation: 6};
}

function yAxis(height) {
  return {tickCount: Math.max(3, Math.floor(height / 38)), grid: true, domain: false, ticks: false,
    minExtent: yAxisWidth, maxExtent: yAxisWidth};
}

/**
 * Lines with bands over one axis; margins as triangles on the axis; beneath, in a strip, a share from 0 to 1.
 * panel: {rows, strip, margins, nominal, impossible, policies: [{name, place}], x: {title, domain, log}, y: {title, domain}, title,
 * markers, shade}.
 */
function curvePanel(look, panel, width, height, legend = false) {
  const inner = Math.max(60, width - yAxisWidth - rightAir);
  const {color, dash, shape} = policyEncoding(look, panel.policies, legend);
  const hasStrip = panel.strip.length > 0;
  const xOf = (last) => quantitative('level', {...panel.x, title: last ? panel.x.title : null,
    axis: {...xAxis(inner), labels: last, ...(last ? {} : {title: null, ticks: false})}});
  const y = quantitative('value', {...panel.y, axis: yAxis(height)});
  const layers = [
    {
      transform: [{filter: 'isValid(datum.low) && isValid(datum.high)'}],
      mark: {type: 'area', opacity: panel.shade, clip: true},
      encoding: {x: xOf(!hasStrip), y: {...y, field: 'low'}, y2: {field: 'high'}, color},
    },
    {mark: {type: 'line', strokeWidth: 1.75, clip: Boolean(panel.y.domain)}, encoding: {x: xOf(!hasStrip), y, color, strokeDash: dash}},
  ];
  if (panel.markers) {
    layers.push({mark: {type: 'point', filled: true, size: 26, opacity: 1}, encoding: {x: xOf(!hasStrip), y, color, shape}});
  }
  if (panel.margins.length > 0) {
    layers.push({
      data: {values: panel.margins},
      mark: {type: 'point', shape: 'triangle-up', filled: true, size: 64, opacity: 1, yOffset: -4, stroke: look.colour('--paper'), strokeWidth: 1},
      encoding: {x: xOf(!hasStrip), y: {value: height}, color},
    });
  }
  if (panel.impossible.length > 0) {
    layers.unshift({
      data: {values: panel.impossible},
      mark: {type: 'rect', color: look.colour('--bad'), opacity: 0.1, tooltip: {content: 'data'}},
      encoding: {
        x: {...xOf(!hasStrip), field: 'from'}, x2: {field: 'to'}, y: {value: 0}, y2: {value: height},
        tooltip: {value: 'no policy can hold the plant here'},
      },
    });
  }
  if (panel.nominal !== null) {
    layers.unshift({
      data: {values: [{level: panel.nominal}]},
      mark: {type: 'rule', color: look.colour('--ink-3'), strokeDash: [2, 3]},
      encoding: {x: xOf(!hasStrip)},
    });
  }
  const main = {width: inner, height, data: {values: panel.rows}, layer: layers};
  if (panel.title) main.title = panel.title;
  const strip = {
    width: inner, height: 26, data: {values: panel.strip},
    mark: {type: 'line', strokeWidth: 1.5},
    encoding: {
      x: xOf(true), color, strokeDash: dash,
      y: {field: 'share', type: 'quantitative', title: null, scale: {domain: [0, 1]},
        axis: {...yAxis(26), values: [0, 1], format: '%', grid: true, tickCount: 2}},
    },
  };
  return hasStrip ? {vconcat: [main, strip], spacing: 14, bounds: 'flush'} : main;
}

/** A whole specification around a panel or a concatenation of panels. */
function standalone(content, name) {
  return {$schema: schema, description: name, padding: {left: 4, right: 4, top: 6, bottom: 4}, ...content};
}

/** Panels side by side and one above the other, for a file. */
function gridOfPanels(rows, name) {
  return standalone({title: {text: name, fontSize: 14, offset: 14}, spacing: 18,
    vconcat: rows.map((row) => ({hconcat: row, spacing: 18}))}, name);
}

/**
 * Learning curves of one policy. panel: {place, runs: [{seed, step, value}], mean: [{step, value, low, high}],
 * others: [{source, step, value}], domain: {x, y}, title, yTitle}.
 */
function learningPanel(look, panel, width, height) {
  const inner = Math.max(60, width - yAxisWidth - rightAir);
  const colour = policyColour(look, panel.place);
  const x = quantitative('step', {title: 'training steps', domain: panel.domain.x, axis: {...xAxis(inner), format: '~s'}});
  const y = quantitative('value', {title: panel.yTitle, domain: panel.domain.y, axis: yAxis(height)});
  const line = (values, mark, more = {}) => ({data: {values}, mark: {type: 'line', clip: true, ...mark}, encoding: {x, y, ...more}});
  const content = {
    width: inner, height,
    layer: [
      line(panel.others, {color: look.colour('--ink-3'), strokeWidth: 1.6, strokeDash: [4, 3]}, {detail: {field: 'source', type: 'nominal'}}),
      line(panel.runs, {color: colour, opacity: 0.35, strokeWidth: 1}, {detail: {field: 'seed', type: 'nominal'}}),
      {
        data: {values: panel.mean.filter((row) => row.low !== null)},
        mark: {type: 'area', opacity: 0.18, color: colour, clip: true},
        encoding: {x, y: {...y, field: 'low'}, y2: {field: 'high'}},
      },
      line(panel.mean, {color: colour, strokeWidth: 2.2}),
    ],
  };
  if (panel.title) content.title = panel.title;
  return content;
}

/** A map of one metric over two parameters. panel: {rows: [{column, row, value}], columns, lines, metric, domain, title}. */
function heatPanel(look, panel, width, height) {
  const inner = Math.max(80, width - 44 - rightAir);
  const axis = (field, names, of) => ({
    field, type: 'ordinal', title: axisTitle(of.name, of.unit), sort: names,
    axis: {labelOverlap: 'greedy', domain: false, ticks: false, labelAngle: 0, minExtent: field === 'row' ? 40 : 0},
  });
  const content = {
    width: inner, height, data: {values: panel.rows},
    mark: {type: 'rect', stroke: look.colour('--paper'), strokeWidth: 0.5},
    encoding: {
      x: axis('column', panel.columns.v.map(pretty), panel.columns),
      y: {...axis('row', panel.lines.v.map(pretty), panel.lines), sort: panel.lines.v.map(pretty).reverse()},
      color: {field: 'value', type: 'quantitative', scale: {scheme: 'cividis', domain: panel.domain},
        legend: {title: panel.metric, orient: 'top', gradientLength: Math.min(160, inner - 20), gradientThickness: 8, titlePadding: 4}},
      tooltip: [
        {field: 'column', type: 'nominal', title: panel.columns.name}, {field: 'row', type: 'nominal', title: panel.lines.name},
        {field: 'value', type: 'quantitative', title: panel.metric, format: '.4~g'},
      ],
    },
  };
  if (panel.title) content.title = panel.title;
  return content;
}

/**
 * Lines over time, one view a group. groups: [{title, lines: [{name, colour, dash}], step, domain, rows: [{name, time, value}]}].
 */
function timePlots(look, groups, domain, width, height) {
  const inner = Math.max(60, width - yAxisWidth - rightAir);
  const view = (group, last) => ({
    width: inner, height, data: {values: group.rows},
    mark: {type: 'line', strokeWidth: 1.5, interpolate: group.step ? 'step-after' : 'linear'},
    encoding: {
      x: quantitative('time', {title: last ? 'time [s]' : null, domain, axis: {...xAxis(inner), labels: last, ticks: last, domain: last}}),
      y: quantitative('value', {title: group.title, domain: group.domain,
        axis: {...yAxis(height), titleAngle: 0, titleAlign: 'left', titleAnchor: 'end', titleX: -yAxisWidth, titleY: -8, titleBaseline: 'bottom'}}),
      color: lineChannel(group, inner, group.lines.map((line) => look.colour(line.colour))),
      strokeDash: lineChannel(group, inner, group.lines.map((line) => line.dash)),
    },
  });
  return {
    vconcat: groups.map((group, index) => view(group, index === groups.length - 1)), spacing: 32, bounds: 'flush',
    resolve: {scale: {color: 'independent', strokeDash: 'independent'}, legend: {color: 'independent', strokeDash: 'independent'}},
  };
}

/** A channel that tells the lines of a view apart; where there are several, with a legend at the right end of its title. */
function lineChannel(group, width, range) {
  const names = group.lines.map((line) => line.name);
  const taken = names.reduce((sum, name) => sum + 32 + 6 * Math.min(name.length, 18), 0);
  const legend = names.length < 2 ? null : {
    title: null, orient: 'none', direction: 'horizontal', legendX: Math.max(90, width - taken), legendY: -19, symbolType: 'stroke',
    symbolSize: 160, symbolStrokeWidth: 2, columnPadding: 8, labelFontSize: 10.5, labelLimit: 110,
  };
  return {field: 'name', type: 'nominal', legend, scale: {domain: names, range}};
}
