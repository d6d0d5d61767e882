// Two parameters at once: one map a policy.

function layersOf(grid) {
  return data.layers.filter((layer) => layer.g === grid && layer.t === state.start && layer.m === state.metric && !state.hidden.has(layer.p));
}

function heatRows(grid, layer) {
  const {columns, rows} = data.grids[grid];
  return layer.v.map((value, i) => ({
    column: pretty(columns.v[i % columns.v.length]), row: pretty(rows.v[Math.floor(i / columns.v.length)]), value: finite(value),
  }));
}

function heatOf(grid, layer, title) {
  const all = layersOf(grid).flatMap((one) => one.v);
  return {
    rows: heatRows(grid, layer), columns: data.grids[grid].columns, lines: data.grids[grid].rows,
    metric: data.metrics[state.metric].name, domain: metricDomain(state.metric) ?? extent(all) ?? [0, 1],
    title: title ? `${data.grids[grid].name}, ${data.policies[layer.p].name}` : null,
  };
}

function heatTable() {
  return data.grids.flatMap((grid, index) => layersOf(index).flatMap((layer) => layer.v.map((value, i) => ({
    grid: grid.name, policy: data.policies[layer.p].name, start: data.starts[state.start].name, metric: data.metrics[state.metric].name,
    [grid.columns.name]: grid.columns.v[i % grid.columns.v.length], [grid.rows.name]: grid.rows.v[Math.floor(i / grid.columns.v.length)], value,
  }))));
}

function heatFigure(figure) {
  const tiles = element('div', {class: 'tiles'});
  let live = [];
  const build = () => {
    for (const chart of live) chart.remove();
    live = [];
    tiles.replaceChildren();
    data.grids.forEach((grid, index) => {
      for (const layer of layersOf(index)) {
        const host = element('div', {class: 'panel map'});
        tiles.append(element('div', {class: 'tile'},
          element('h4', {}, swatch(placeOf(layer.p)), ` ${data.policies[layer.p].name}`, element('small', {}, grid.name)), host));
        live.push(new Chart(host, (width) => standalone(heatPanel(onScreen, heatOf(index, layer), width - 8, 240), grid.name),
          () => `${data.metrics[state.metric].title} of ${data.policies[layer.p].name} over ${grid.columns.name} and ${grid.rows.name}`));
      }
    });
    if (live.length === 0) tiles.append(element('p', {class: 'empty'}, `No map of ${data.metrics[state.metric]?.name} for these choices.`));
  };
  onChange(build);
  build();
  const used = (key) => distinct(data.layers.map((layer) => layer[key]));
  figure.querySelector('.body').append(
    element('div', {class: 'choices'}, metricSelect(used('m')), startChoice(used('t')), policyKey(used('p'))), tiles);
  addTools(figure, {
    name: 'grids', rows: heatTable,
    commands: () => [['the study', data.runCommand], ...data.grids.map((grid) => [grid.name, grid.command])],
    spec: () => gridOfPanels(data.grids.flatMap((_, index) => layersOf(index).map((layer) => [heatPanel(inFile, heatOf(index, layer, true), 420, 280)])), data.name),
  });
}
