// An episode over time: states, actions, disturbances, reward, each in a view of its own under one time axis.

const channelColours = ['--p1', '--p3', '--p0', '--p4', '--p2', '--p5', '--p6', '--p7'];

function isRate(name) {
  return name.endsWith('_dot') || ['p', 'q', 'r'].includes(name);
}

function timeRows(name, values, rate) {
  return values.map((value, k) => ({name, time: k / rate, value: finite(value)})).filter((row) => row.value !== null);
}

/** One view. What is held over a control step is drawn as steps, to the end of the last one, on an axis with zero. */
function group(title, traces, rate, step = false) {
  const rows = traces.flatMap((trace) => timeRows(trace.name, step ? [...trace.v, ...trace.v.slice(-1)] : trace.v, rate));
  const domain = padded(extent([...rows.map((row) => row.value), ...(step ? [0] : [])]) ?? [0, 1], 0.08);
  return {title, rows, domain, step, lines: traces.map((trace) => ({name: trace.name, colour: trace.colour, dash: trace.dash ?? []}))};
}

/** What a moving reference asks of a state. */
function referenceOf(episode, state) {
  const asked = episode.reference.find((trace) => trace.name === state.name);
  return asked ? [{...asked, name: `${state.name} reference`, colour: '--ink-3', dash: [2, 3]}] : [];
}

/** What was injected at a site. */
function pushGroup(episode, site, title) {
  const traces = episode.disturbances.filter((push) => push.site === site);
  const units = new Set(traces.map((trace) => trace.unit));
  return group(axisTitle(title, units.size === 1 ? traces[0].unit : ''),
    traces.map((trace, i) => ({...trace, colour: channelColours[i % channelColours.length], dash: dashes[i % dashes.length]})), episode.rate, true);
}

/** The views of an episode; rates of change only when asked for. */
function episodeGroups(episode, rates) {
  const rate = episode.rate;
  const groups = episode.states.filter((trace) => rates || !isRate(trace.name)).map((trace) =>
    group(axisTitle(episode.observed ? `${trace.name} observed` : trace.name, trace.unit), [...referenceOf(episode, trace), {...trace, colour: '--ink'}], rate));
  const actions = episode.applied.flatMap((trace, i) => [
    ...(episode.commanded[i] ? [{...episode.commanded[i], name: `${trace.name} commanded`, colour: '--commanded', dash: i === 0 ? [4, 2] : [1, 2]}] : []),
    {...trace, name: `${trace.name} applied`, colour: '--applied', dash: i === 0 ? [] : [6, 2]},
  ]);
  if (actions.length > 0) groups.push(group(axisTitle('action', episode.applied[0].unit), actions, rate, true));
  for (const trace of episode.memory ?? []) groups.push(group(axisTitle(trace.name, trace.unit), [{...trace, colour: '--ink'}], rate, true));
  for (const site of new Set(episode.disturbances.map((push) => push.site))) groups.push(pushGroup(episode, site, `disturbance of the ${site}`));
  groups.push(group('reward', [{name: 'reward', v: episode.reward, colour: '--ink'}], rate, true));
  return groups;
}

/** An episode as a table, one row a control step; the last row is the final state. */
function episodeRows(episode) {
  const at = (values, k) => values[k] ?? null;
  return episode.states[0].v.map((_, k) => ({
    step: k, time: k / episode.rate,
    ...Object.fromEntries(episode.states.map((trace) => [trace.name, at(trace.v, k)])),
    ...Object.fromEntries(episode.commanded.map((trace) => [`${trace.name}_commanded`, at(trace.v, k)])),
    ...Object.fromEntries(episode.applied.map((trace) => [`${trace.name}_applied`, at(trace.v, k)])),
    ...Object.fromEntries((episode.memory ?? []).map((trace) => [trace.name, at(trace.v, k)])),
    ...Object.fromEntries(episode.disturbances.map((push) => [`${push.site}_${push.name}`, at(push.v, k)])),
    reward: at(episode.reward, k),
  }));
}
