// The planar quadrotor, drawn from the true state: the path it should fly, its thrusts, the wind.

const armDrawn = 0.13;  // [m] half width of the drawn body; the real one has 0.06

function quadrotorModel(episode) {
  const steady = (values, most) => (values ?? [0]).map((value) => Math.max(-most, Math.min(most, value)));
  const reference = {x: traceOf(episode.reference, 'x'), z: traceOf(episode.reference, 'z')};
  const limit = episode.geometry.x_limit ?? 2;
  const x = steady(traceOf(episode.states, 'x'), 2 * limit);
  const z = steady(traceOf(episode.states, 'z'), 2 * limit);
  const spread = (list) => list.filter(Boolean).flat();
  const reach = Math.min(limit, largest([x, reference.x])) + 0.35;
  const [fx, fz] = [pushOf(episode, 'dynamics', 'fx'), pushOf(episode, 'dynamics', 'fz')];
  return {
    x, z, theta: traceOf(episode.states, 'theta') ?? [0], reference, limit, reach, fx, fz,
    floor: episode.geometry.floor ?? 0, top: Math.min(limit, Math.max(1, ...spread([z, reference.z]))) + 0.3,
    commanded: episode.commanded.map((trace) => trace.v), applied: episode.applied.map((trace) => trace.v),
    added: episode.applied.map((trace) => episode.disturbances.find((push) => push.site === 'action' && push.name === trace.name)?.v ?? null),
    seen: ['x', 'z', 'theta'].map((name) => pushOf(episode, 'observation', name)),
    thrustReach: episode.geometry.action_limit || 1, pushReach: largest([fx, fz]) || 1,
  };
}

function quadrotorBody(scale) {
  const arm = armDrawn * scale;
  const rotor = (side) => svgElement('g', {transform: `translate(${side * arm * 0.8} ${-0.035 * scale})`},
    svgElement('line', {class: 'mast', x1: 0, x2: 0, y1: 0, y2: 0.035 * scale}), svgElement('ellipse', {class: 'disc', rx: 0.42 * arm, ry: 0.012 * scale}));
  return svgElement('g', {class: 'drone'}, svgElement('line', {class: 'frame', x1: -arm, x2: arm, y1: 0, y2: 0}),
    svgElement('circle', {class: 'hub', r: Math.max(3, 0.028 * scale)}), rotor(-1), rotor(1));
}

/** Ground, bounds and the path of the reference. */
function airspace(model, scale) {
  const group = svgElement('g', {class: 'track'});
  const far = 2 * model.limit;
  const y = -(model.floor - 0.02) * scale;
  group.append(svgElement('line', {x1: -far * scale, x2: far * scale, y1: y, y2: y, class: 'rail'}));
  for (let half = -far * 2; half <= far * 2; ++half) {
    const whole = half % 2 === 0;
    group.append(svgElement('line', {x1: (half / 2) * scale, x2: (half / 2) * scale, y1: y, y2: y + (whole ? 7 : 4), class: 'tick'}));
    if (whole) group.append(svgElement('text', {x: (half / 2) * scale, y: y + 20}, pretty(half / 2)));
  }
  for (const side of [-1, 1]) {
    const x = side * model.limit * scale;
    group.append(svgElement('rect', {x: side > 0 ? x : x - far * scale, y: -far * scale, width: far * scale, height: far * scale + y, class: 'outside'}),
      svgElement('line', {x1: x, x2: x, y1: -far * scale, y2: y, class: 'limit'}));
  }
  if (model.reference.x) group.append(svgElement('path', {class: 'path', d: pathOf(model.reference.x, model.reference.z, scale, 0, model.reference.x.length - 1)}));
  return group;
}

function pathOf(x, z, scale, from, to) {
  const points = [];
  for (let k = from; k <= to; ++k) points.push(`${(x[k] * scale).toFixed(1)} ${(-z[k] * scale).toFixed(1)}`);
  return points.length > 1 ? `M${points.join('L')}` : '';
}

/** The scene of an episode for a width in pixels: {node, draw(time)}; time in control steps. */
function quadrotorScene(episode, width) {
  const model = quadrotorModel(episode);
  const scale = Math.min(width / (2 * model.reach), 400 / (model.top - model.floor));
  const height = (model.top - model.floor) * scale + 34;
  const [drone, ghost] = [quadrotorBody(scale), quadrotorBody(scale)];
  const seen = svgElement('g', {class: 'seen'}, ghost);
  const thrusts = [0, 1].map(() => ({commanded: arrow('commanded'), added: arrow('push'), applied: arrow('applied')}));
  const wind = arrow('push');
  const trail = svgElement('path', {class: 'trail'});
  const target = svgElement('circle', {class: 'target', r: 5});
  const world = svgElement('g', {}, airspace(model, scale), trail, target, seen, drone, ...thrusts.flatMap((one) => [one.commanded, one.added, one.applied]), wind);
  const node = svgElement('svg', {class: 'scene', width, height, viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': 'Quadrotor'}, world);
  const sees = model.seen.some(Boolean);
  seen.style.display = sees ? '' : 'none';
  target.style.display = model.reference.x ? '' : 'none';
  const visible = width / 2 / scale;

  const place = (body, x, z, theta) => body.setAttribute('transform', `translate(${x * scale} ${-z * scale}) rotate(${(theta * 180) / Math.PI})`);
  const drawThrusts = (time, x, z, theta) => {
    const [up, along] = [[Math.sin(theta), -Math.cos(theta)], [Math.cos(theta), Math.sin(theta)]];
    const reach = (0.55 * scale) / model.thrustReach;
    [-1, 1].forEach((side, i) => {  // T1 is on the side of +x
      const draw = (which, values, shift) => {
        const value = held(values, time) * reach;
        const offset = side * armDrawn * 0.8 * scale + shift;
        point(thrusts[i][which], x * scale + along[0] * offset, -z * scale + along[1] * offset, up[0] * value, up[1] * value);
      };
      const pair = 1 - i;
      draw('commanded', model.commanded[pair], -4);
      draw('added', model.added[pair], 0);
      draw('applied', model.applied[pair], 4);
    });
  };
  const draw = (time) => {
    const [x, z, theta] = [between(model.x, time), between(model.z, time), between(model.theta, time)];
    const camera = Math.abs(x) > visible - 0.3 ? x - Math.sign(x) * (visible - 0.3) : 0;
    world.setAttribute('transform', `translate(${width / 2 - camera * scale} ${model.top * scale})`);
    place(drone, x, z, theta);
    if (sees) place(ghost, ...[x, z, theta].map((value, i) => value + held(model.seen[i], time)));
    drawThrusts(time, x, z, theta);
    const windScale = (0.25 * scale) / model.pushReach;
    point(wind, x * scale, -z * scale, held(model.fx, time) * windScale, -held(model.fz, time) * windScale);
    const last = Math.min(Math.floor(time), model.x.length - 1);
    trail.setAttribute('d', pathOf(model.x, model.z, scale, Math.max(0, last - 60), last));
    if (!model.reference.x) return;
    target.setAttribute('cx', between(model.reference.x, time) * scale);
    target.setAttribute('cy', -between(model.reference.z, time) * scale);
  };
  return {node, draw};
}
