// The player: one clock that the scene, the plots, the read-outs and the scrubber follow.

const speeds = [0.05, 0.1, 0.25, 0.5, 1, 2];
const calm = window.matchMedia('(prefers-reduced-motion: reduce)');

class Player {
  constructor(steps, rate, onTick, onState) {
    Object.assign(this, {steps, rate, onTick, onState, time: 0, speed: 1, playing: false, frame: 0});
  }

  seek(time) {
    this.time = Math.max(0, Math.min(this.steps, time));
    this.onTick(this.time);
  }

  step(count) {
    this.pause();
    this.seek(Math.round(this.time) + count);
  }

  play() {
    if (this.playing) return;
    if (this.time >= this.steps) this.time = 0;
    this.playing = true;
    this.onState();
    let before = performance.now();
    const turn = (now) => {
      if (!this.playing) return;
      this.seek(this.time + ((now - before) / 1000) * this.rate * this.speed);
      before = now;
      if (this.time >= this.steps) return this.pause();
      this.frame = requestAnimationFrame(turn);
    };
    this.frame = requestAnimationFrame(turn);
  }

  pause() {
    cancelAnimationFrame(this.frame);
    this.playing = false;
    this.onState();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  changeSpeed(by) {
    const at = speeds.indexOf(this.speed) + by;
    this.speed = speeds[Math.max(0, Math.min(speeds.length - 1, at))];
    this.onState();
  }
}

/** Everything of the replay figure; the episode shown is `episode`. */
class Replay {
  constructor(figure) {
    this.figure = figure;
    this.episode = data.episodes[0];
    this.rates = false;
    this.player = new Player(0, 1, (time) => this.tick(time), () => this.label());
    this.build();
    this.show(this.episode);
  }

  build() {
    const button = (label, title, onclick) => element('button', {type: 'button', title, 'aria-label': title, onclick}, label);
    this.select = element('select', {'aria-label': 'Episode', onchange: () => this.show(data.episodes[this.select.selectedIndex])},
      ...data.episodes.map((episode) => element('option', {}, episode.title)));
    this.playButton = button('', 'Play', () => this.player.toggle());
    this.playButton.classList.add('play');
    this.speedLabel = element('output', {class: 'speed', 'aria-label': 'Speed'});
    this.scrub = element('input', {type: 'range', min: 0, step: 1, value: 0, 'aria-label': 'Time',
      oninput: () => { this.player.pause(); this.player.seek(Number(this.scrub.value)); }});
    this.stage = element('div', {class: 'stage'});
    this.views = 0;
    this.readout = element('dl', {class: 'readout'});
    this.badge = element('p', {class: 'badge', 'aria-live': 'polite'});
    this.plots = element('div', {class: 'panel time-plots'});
    this.ratesButton = element('button', {type: 'button', 'aria-pressed': 'false', title: 'Plot the rates of change too', onclick: () => this.toggleRates()}, 'Rates');
    this.figure.querySelector('.body').append(
      element('div', {class: 'choices'}, element('label', {class: 'choice grow'}, element('span', {class: 'label'}, 'Episode'), this.select),
        element('div', {class: 'segmented'}, button('‹', 'Previous episode', () => this.move(-1)), button('›', 'Next episode', () => this.move(1))),
        this.ratesButton),
      element('div', {class: 'replay'},
        element('div', {class: 'left'}, element('div', {class: 'window'}, this.stage, this.badge),
          element('div', {class: 'transport'}, this.playButton, button('−', 'Slower', () => this.player.changeSpeed(-1)), this.speedLabel,
            button('+', 'Faster', () => this.player.changeSpeed(1)), this.scrub),
          this.readout, this.legend()),
        element('div', {class: 'right'}, this.plots)));
    this.cursor = element('div', {class: 'crosshair cursor'});
    this.fall = element('div', {class: 'crosshair fall'});
    this.chart = new Chart(this.plots, (width) => standalone(this.spec(onScreen, width - 8), this.episode.title), () => `Episode over time: ${this.episode.title}`);
    this.chart.after = () => this.measure();
    this.plots.append(this.cursor, this.fall);
    this.listen();
  }

  legend() {
    const entry = (kind, text) => element('span', {class: `mark ${kind}`}, text);
    this.seenEntry = entry('seen', 'as the policy sees it');
    this.pushEntry = entry('push', 'disturbance');
    return element('p', {class: 'legend'}, entry('commanded', 'action commanded'), entry('applied', 'action applied'), this.pushEntry, this.seenEntry);
  }

  listen() {
    this.figure.addEventListener('keydown', (event) => this.key(event));
    const scrubTo = (event) => {
      const frame = this.chart.frame();
      if (!frame) return;
      this.player.pause();
      this.player.seek(Math.round(((event.clientX - frame.left) / frame.width) * this.player.steps));
    };
    this.plots.addEventListener('pointerdown', (event) => {
      if (event.pointerType === 'mouse') event.preventDefault();
      scrubTo(event);
    });
    this.plots.addEventListener('pointermove', (event) => {
      if (event.buttons > 0) scrubTo(event);
    });
    new ResizeObserver(() => {
      if (Math.abs(this.stage.clientWidth - this.stageWidth) > 4) this.stageScene();
    }).observe(this.stage);
  }

  key(event) {
    if (event.target.matches('select, input[type=text]') || event.ctrlKey || event.metaKey || event.altKey) return;
    const many = event.shiftKey ? 10 : 1;
    const actions = {
      ' ': () => this.player.toggle(), ArrowLeft: () => this.player.step(-many), ArrowRight: () => this.player.step(many),
      Home: () => this.player.step(-Infinity), End: () => this.player.step(Infinity),
      '[': () => this.player.changeSpeed(-1), ']': () => this.player.changeSpeed(1),
    };
    const action = actions[event.key];
    if (!action || (event.key === ' ' && event.target.matches('button'))) return;
    event.preventDefault();
    action();
  }

  move(by) {
    const count = data.episodes.length;
    this.show(data.episodes[(data.episodes.indexOf(this.episode) + by + count) % count]);
  }

  toggleRates() {
    this.rates = !this.rates;
    this.ratesButton.setAttribute('aria-pressed', String(this.rates));
    this.chart.touch();
  }

  spec(look, width) {
    const groups = episodeGroups(this.episode, this.rates);
    this.views = groups.length;
    return timePlots(look, groups, [0, this.episode.reward.length / this.episode.rate], width, 54);
  }

  show(episode) {
    this.player.pause();
    this.episode = episode;
    this.select.selectedIndex = data.episodes.indexOf(episode);
    this.player.steps = episode.reward.length;
    this.player.rate = episode.rate;
    this.frame = null;
    this.fall.hidden = true;
    this.scrub.max = String(this.player.steps);
    this.stage.dataset.policy = placeOf(episode.p);
    const sites = new Set(episode.disturbances.map((push) => push.site));
    this.pushEntry.hidden = !sites.has('dynamics') && !sites.has('action');
    this.seenEntry.hidden = !sites.has('observation');
    this.stageScene();
    this.player.seek(0);
    this.chart.touch();
  }

  stageScene() {
    const build = sceneOf(this.episode);
    this.stageWidth = this.stage.clientWidth;
    this.scene = build && this.stageWidth > 0 ? build(this.episode, this.stageWidth) : null;
    this.stage.replaceChildren(...(this.scene ? [this.scene.node] : []));
    this.stage.hidden = !build;
    this.scene?.draw(this.player.time);
  }

  tick(time) {
    const shown = calm.matches ? Math.floor(time) : time;
    const step = Math.floor(time);
    this.scene?.draw(shown);
    this.scrub.value = String(step);
    this.scrub.setAttribute('aria-valuetext', `${(step / this.episode.rate).toFixed(2)} seconds`);
    this.tell(step);
    this.place();
  }

  /** Finds where the drawn plots lie, once a drawing. */
  measure() {
    const host = this.plots.getBoundingClientRect();
    const first = this.chart.frame(0);
    const last = this.chart.frame(this.views - 1);
    this.frame = first && last ? {left: first.left - host.left, width: first.width, top: first.top - host.top, height: last.bottom - first.top} : null;
    this.place();
    const failed = this.episode.failed;
    this.fall.hidden = !this.frame || failed === undefined;
    if (!this.fall.hidden) this.put(this.fall, failed);
  }

  put(line, step) {
    const {left, width, top, height} = this.frame;
    line.style.cssText = `left:0;transform:translateX(${left + (step / this.player.steps) * width}px);top:${top}px;height:${height}px`;
  }

  /** Moves the cursor of the plots. */
  place() {
    this.cursor.hidden = !this.frame || this.player.time === 0;
    if (!this.cursor.hidden) this.put(this.cursor, Math.min(this.player.time, this.player.steps));
  }

  tell(step) {
    const {episode} = this;
    const fixed = (value, digits) => (value === null || value === undefined ? '–' : value.toFixed(digits).replace('-', '−'));
    const entry = (name, value, unit) => element('div', {}, element('dt', {}, name), element('dd', {}, value, unit ? element('small', {}, ` ${unit}`) : ''));
    const states = episode.states.filter((trace) => !isRate(trace.name)).map((trace) => trace.unit === 'rad'
      ? entry(trace.name, fixed(trace.v[step] === null ? null : (trace.v[step] * 180) / Math.PI, 1), '°')
      : entry(trace.name, fixed(trace.v[step], 3), trace.unit));
    const actions = episode.applied.map((trace) => entry(trace.name, fixed(trace.v[Math.min(step, trace.v.length - 1)], 2), trace.unit));
    this.readout.replaceChildren(entry('time', fixed(step / episode.rate, 2), 's'), ...states, ...actions,
      entry('reward', fixed(episode.reward[Math.min(step, episode.reward.length - 1)], 3), ''));
    const failed = episode.failed !== undefined && step >= episode.failed;
    this.badge.className = failed ? 'badge failed' : 'badge';
    const text = failed ? `Failed at ${(episode.failed / episode.rate).toFixed(2)} s${episode.failure ? `: ${episode.failure}` : ''}`
      : step >= this.player.steps ? (episode.ground ? 'Came down to the ground: from there its motion is an approximation'
        : episode.plant === 'cartpole' ? 'Still standing at the end' : episode.observed ? 'Lasted to the end' : 'Within its bounds to the end') : '';
    if (this.badge.textContent !== text) this.badge.textContent = text;
  }

  label() {
    const {playing, speed} = this.player;
    this.playButton.textContent = playing ? '❚❚' : '▶';
    this.playButton.title = playing ? 'Pause' : 'Play';
    this.playButton.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    this.speedLabel.textContent = `${speed}×`;
  }
}

function replayFigure(figure) {
  if (data.episodes.length === 0) return;
  const replay = new Replay(figure);
  addTools(figure, {
    name: 'replay', rows: () => episodeRows(replay.episode),
    spec: () => standalone({title: replay.episode.title, ...replay.spec(inFile, 640)}, replay.episode.title),
    commands: () => [['the cell of this episode', replay.episode.command], ['the study', data.runCommand]],
  });
  for (const button of root.querySelectorAll('[data-watch]')) {
    const episode = data.episodes.find((one) => one.number === Number(button.dataset.watch));
    button.disabled = !episode;
    button.addEventListener('click', () => {
      replay.show(episode);
      figure.scrollIntoView({behavior: calm.matches ? 'auto' : 'smooth', block: 'start'});
      replay.playButton.focus({preventScroll: true});
      if (!calm.matches) replay.player.play();
    });
  }
}
