// What the reader has chosen to see of a dataset. This script and those that speak of `data`, `root` or `state` are the body of
// startFigures(root, data), which brings one dataset's figures to life; a page may have several, and they know nothing of
// each other.

const shownAtFirst = 8;  // policies; the reader adds the rest

const state = {
  metric: 0,
  start: 0,
  hidden: new Set(data.policies.map((_, index) => index).slice(shownAtFirst)),
};

const listeners = [];

/** Calls a function after every change of the state. */
function onChange(listener) {
  listeners.push(listener);
}

function change(patch) {
  Object.assign(state, patch);
  for (const listener of listeners) listener();
}

function visiblePolicies() {
  return data.policies.filter((_, index) => !state.hidden.has(index));
}

/** Where a policy stands in the order of colours, dashes and markers. */
function placeOf(policy) {
  return data.policies[policy].place;
}

const curveOf = new Map();  // "sweep/start/metric" -> curves, one a policy
for (const curve of data.curves) {
  const key = `${curve.s}/${curve.t}/${curve.m}`;
  if (!curveOf.has(key)) curveOf.set(key, []);
  curveOf.get(key).push(curve);
}

/** The curves of a sweep, one for each policy that has one. */
function curvesOf(sweep, start, metric) {
  return curveOf.get(`${sweep}/${start}/${metric}`) ?? [];
}
