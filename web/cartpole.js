// The cart-pole, drawn to scale from the true state: what it does, what pushes it, what the policy believes.

const cartHalf = 0.2;  // [m] half width of the drawn cart; its size is no parameter of the plant
const cartHigh = 0.17;
const arrowReach = 0.9;  // [m] drawn length of the largest push; a command beyond what can be applied is drawn a little longer

const farthest = 40;  // [m] the scene's end: a cart that has run away stays there

function traceOf(list, name) {
  return list.find((trace) => trace.name === name)?.v.map((value) => finite(value) ?? 0) ?? null;
}

function pushOf(episode, site, name) {
  return episode.disturbances.find((push) => push.site === site && push.name === name)?.v.map((value) => finite(value) ?? 0) ?? null;
}

function largest(traces) {
  return traces.filter(Boolean).reduce((most, values) => values.reduce((sum, value) => Math.max(sum, Math.abs(finite(value) ?? 0)), most), 0);
}

/** What of an episode is drawn, with its bounds in metres. */
function cartpoleModel(episode) {
  const geometry = episode.geometry;
  const half = geometry.pole_length ?? 0.5;
  const theta = traceOf(episode.states, 'theta') ?? [0];
  const lowest = Math.min(0, ...theta.map((angle) => 2 * half * Math.cos(angle)));
  const fx = pushOf(episode, 'dynamics', 'fx');
  const fz = pushOf(episode, 'dynamics', 'fz');
  return {
    half, theta, fx, fz, x: (traceOf(episode.states, 'x') ?? [0]).map((x) => Math.max(-farthest, Math.min(farthest, x))), limit: geometry.x_limit ?? 2.4,
    tap: geometry.tap_distance ?? half, actionPush: episode.disturbances.find((push) => push.site === 'action')?.v ?? null,
    commanded: episode.commanded[0]?.v ?? [], applied: episode.applied[0]?.v ?? [], unit: episode.applied[0]?.unit ?? '',
    seenX: pushOf(episode, 'observation', 'x'), seenTheta: pushOf(episode, 'observation', 'theta'),
    actionReach: geometry.action_limit || largest([episode.applied[0]?.v]) || 1,
    pushReach: largest([fx, fz]) || 1,
    below: Math.max(0.42, cartHigh / 2 - lowest + 0.1), above: 2 * half + 0.3,
  };
}

/** Value at a time in steps; between two steps a line, unless the reader wants no motion. */
function between(values, time) {
  const k = Math.min(Math.floor(time), values.length - 1);
  const next = Math.min(k + 1, values.length - 1);
  return values[k] + (values[next] - values[k]) * (time - k);
}

function held(values, time) {
  return values && values.length > 0 ? finite(values[Math.min(Math.floor(time), values.length - 1)]) ?? 0 : 0;
}

function arrow(name) {
  return svgElement('g', {class: `arrow ${name}`}, svgElement('line'), svgElement('path', {d: 'M0 0L-9 -4.5L-9 4.5Z'}));
}

/** Points an arrow from (x, y) by (dx, dy), all in pixels; a very short one is not shown. */
function point(group, x, y, dx, dy) {
  const length = Math.hypot(dx, dy);
  group.style.display = length < 2 ? 'none' : '';
  if (length < 2) return;
  const [line, head] = group.children;
  const inner = Math.max(0, 1 - 7 / length);
  line.setAttribute('x1', x);
  line.setAttribute('y1', y);
  line.setAttribute('x2', x + dx * inner);
  line.setAttribute('y2', y + dy * inner);
  const size = Math.min(1, length / 12);
  head.setAttribute('transform', `translate(${x + dx} ${y + dy}) rotate(${(Math.atan2(dy, dx) * 180) / Math.PI}) scale(${size})`);
}

function track(model, scale, reach) {
  const group = svgElement('g', {class: 'track'});
  const y = (cartHigh / 2 + 0.06) * scale;
  const far = Math.max(reach, Math.ceil(largest([model.x])) + 3);
  group.append(svgElement('line', {x1: -far * scale, x2: far * scale, y1: y, y2: y, class: 'rail'}));
  for (let half = Math.ceil(-far * 2); half <= far * 2; ++half) {
    const x = (half / 2) * scale;
    const whole = half % 2 === 0;
    group.append(svgElement('line', {x1: x, x2: x, y1: y, y2: y + (whole ? 7 : 4), class: 'tick'}));
    if (whole) group.append(svgElement('text', {x, y: y + 20}, pretty(half / 2)));
  }
  for (const side of [-1, 1]) {
    const x = side * model.limit * scale;
    const outside = {x: side > 0 ? x : -far * scale, y: -model.above * scale, width: Math.max(0, far * scale - Math.abs(x)), height: model.above * scale + y};
    group.append(svgElement('rect', {...outside, class: 'outside'}),
      svgElement('line', {x1: x, x2: x, y1: -model.above * scale, y2: y, class: 'limit'}),
      svgElement('text', {x: x - side * 5, y: -model.above * scale + 14, class: 'limit-label', 'text-anchor': side > 0 ? 'end' : 'start'},
        `${pretty(side * model.limit)} m`));
  }
  return group;
}

function body(model, scale) {
  const wheel = (x) => svgElement('g', {class: 'wheel', transform: `translate(${x} ${(cartHigh / 2 + 0.01) * scale})`},
    svgElement('circle', {r: 0.05 * scale}), svgElement('line', {x1: 0, x2: 0, y1: -0.045 * scale, y2: 0.045 * scale}));
  const wheels = [wheel(-0.11 * scale), wheel(0.11 * scale)];
  const cart = svgElement('g', {class: 'cart'},
    svgElement('rect', {x: -cartHalf * scale, y: (-cartHigh / 2) * scale, width: 2 * cartHalf * scale, height: cartHigh * scale, rx: 0.03 * scale}),
    ...wheels);
  const pole = svgElement('g', {class: 'pole'},
    svgElement('line', {x1: 0, y1: 0, x2: 0, y2: -2 * model.half * scale}),
    svgElement('circle', {class: 'com', cx: 0, cy: -model.half * scale, r: 3}));
  return {cart, pole, wheels, hinge: svgElement('circle', {class: 'hinge', r: Math.max(3, 0.022 * scale)})};
}

/** The scene of an episode for a width in pixels: {node, draw(time)}; time in control steps. */
function cartpoleScene(episode, width) {
  const model = cartpoleModel(episode);
  const reach = model.limit + 0.45;
  const scale = Math.min(width / (2 * reach), 380 / (model.above + model.below));
  const height = model.above * scale + Math.max(model.below * scale, (cartHigh / 2 + 0.06) * scale + 28);
  const parts = body(model, scale);
  const ghost = body(model, scale);
  const world = svgElement('g');
  const seen = svgElement('g', {class: 'seen'}, ghost.cart, ghost.pole);
  const arrows = {commanded: arrow('commanded'), applied: arrow('applied'), push: arrow('push'), actionPush: arrow('push')};
  const trail = svgElement('path', {class: 'trail'});
  world.append(track(model, scale, reach), trail, seen, parts.cart, parts.pole, parts.hinge, arrows.commanded, arrows.actionPush, arrows.applied, arrows.push);
  const node = svgElement('svg', {class: 'scene', width, height, viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': 'Cart and pole'}, world);
  const sees = Boolean(model.seenX || model.seenTheta);
  seen.style.display = sees ? '' : 'none';
  const visible = width / 2 / scale;

  const place = (those, x, theta) => {
    those.cart.setAttribute('transform', `translate(${x * scale} 0)`);
    those.pole.setAttribute('transform', `translate(${x * scale} 0) rotate(${(theta * 180) / Math.PI})`);
  };
  const draw = (time) => {
    const x = between(model.x, time);
    const theta = between(model.theta, time);
    const camera = Math.abs(x) > visible - 0.4 ? x - Math.sign(x) * (visible - 0.4) : 0;
    world.setAttribute('transform', `translate(${width / 2 - camera * scale} ${model.above * scale})`);
    place(parts, x, theta);
    parts.hinge.setAttribute('cx', x * scale);
    for (const wheel of parts.wheels) wheel.lastChild.setAttribute('transform', `rotate(${((x / 0.05) * 180) / Math.PI})`);
    if (sees) place(ghost, x + held(model.seenX, time), theta + held(model.seenTheta, time));
    const side = (value) => (value >= 0 ? 1 : -1) * cartHalf * scale;
    const push = (value) => Math.max(-1.4, Math.min(1.4, value / model.actionReach)) * arrowReach * scale;
    const [commanded, applied] = [held(model.commanded, time), held(model.applied, time)];
    const added = held(model.actionPush, time);
    point(arrows.commanded, x * scale + side(commanded), -0.055 * scale, push(commanded), 0);
    point(arrows.actionPush, x * scale + side(added), 0, push(added), 0);
    point(arrows.applied, x * scale + side(applied), 0.055 * scale, push(applied), 0);
    const [px, py] = [x + model.tap * Math.sin(theta), -model.tap * Math.cos(theta)];
    const pushScale = (arrowReach * 0.7 * scale) / model.pushReach;
    point(arrows.push, px * scale, py * scale, held(model.fx, time) * pushScale, -held(model.fz, time) * pushScale);
    trail.setAttribute('d', trailPath(model, scale, time));
  };
  return {node, draw};
}

/** The way of the pole's tip over the last half second or so. */
function trailPath(model, scale, time) {
  const last = Math.min(Math.floor(time), model.x.length - 1);
  const points = [];
  for (let k = Math.max(0, last - 30); k <= last; ++k) {
    points.push(`${((model.x[k] + 2 * model.half * Math.sin(model.theta[k])) * scale).toFixed(1)} ${(-2 * model.half * Math.cos(model.theta[k]) * scale).toFixed(1)}`);
  }
  return points.length > 1 ? `M${points.join('L')}` : '';
}
