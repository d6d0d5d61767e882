// What was injected: one panel a sweep, from the first of its kept episodes.

function injectedPanels() {
  return data.sweeps.flatMap((sweep, index) => {
    const episode = data.episodes.find((one) => one.s === index && one.disturbances.some((push) => push.site === sweep.site));
    return episode ? [{sweep, episode, views: [pushGroup(episode, sweep.site, sweep.site)], domain: [0, episode.reward.length / episode.rate]}] : [];
  });
}

function injectedRows(panels) {
  return panels.flatMap(({sweep, views}) => views[0].rows.map((row) => ({sweep: sweep.name, channel: row.name, time: row.time, value: row.value})));
}

function disturbancesFigure(figure) {
  const panels = injectedPanels();
  const tiles = element('div', {class: 'tiles'});
  for (const {sweep, episode, views, domain} of panels) {
    const host = element('div', {class: 'panel'});
    tiles.append(element('div', {class: 'tile'}, element('h4', {}, sweep.name), host));
    new Chart(host, (width) => standalone(timePlots(onScreen, views, domain, width - 8, 170), sweep.name), () => `What was injected: ${episode.title}`);
  }
  figure.querySelector('.body').append(tiles);
  addTools(figure, {
    name: 'disturbances', rows: () => injectedRows(panels), commands: () => [['the study', data.runCommand]],
    spec: () => gridOfPanels(panels.map(({sweep, views, domain}) => [{title: sweep.name, ...timePlots(inFile, views, domain, 420, 170)}]), data.name),
  });
}
