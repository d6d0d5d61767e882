// Charts are drawn when they come near the window, again when their width or the state changes, and all before printing.

const eagerCharts = 80;  // so many are drawn ahead while the browser is idle, or for the printer
const charts = new Set();

const nearWindow = new IntersectionObserver((entries) => {
  for (const entry of entries) {
    const chart = chartOf.get(entry.target);
    chart.near = entry.isIntersecting;
    if (chart.near) chart.refresh();
  }
}, {rootMargin: '300px'});

const widthWatch = new ResizeObserver((entries) => {
  for (const entry of entries) {
    const chart = chartOf.get(entry.target);
    if (Math.abs(entry.contentRect.width - chart.width) > 4) chart.touch();
  }
});

const chartOf = new WeakMap();

class Chart {
  /** build(width) gives a Vega-Lite specification, or null where there is nothing to draw. */
  constructor(host, build, describe) {
    this.host = host;
    this.build = build;
    this.describe = describe;
    this.plot = element('div', {class: 'plot'});
    this.drawn = false;
    this.near = false;
    this.width = 0;
    this.turn = 0;
    this.after = () => {};
    host.classList.add('chart');
    host.setAttribute('role', 'img');
    host.setAttribute('aria-label', describe());
    host.append(this.plot);
    chartOf.set(host, this);
    charts.add(this);
    nearWindow.observe(host);
    widthWatch.observe(host);
  }

  /** Marks the chart as out of date. */
  touch() {
    this.drawn = false;
    if (this.near) this.refresh();
    else startIdleDrawing();
  }

  async refresh() {
    const width = this.host.clientWidth;
    if (this.drawn || width === 0) return;
    this.drawn = true;
    this.width = width;
    const turn = ++this.turn;
    const spec = this.build(width);
    this.host.setAttribute('aria-label', this.describe());
    if (!spec) {
      this.clear();
      this.plot.replaceChildren(element('p', {class: 'empty'}, 'No data'));
      return;
    }
    const target = element('div');
    const result = await vegaEmbed(target, {...spec, config: chartConfig(onScreen)},
      {actions: false, renderer: 'svg', tooltip: vegaTooltip, defaultStyle: false, mode: 'vega-lite'});
    if (turn !== this.turn) {
      result.finalize();
      return;
    }
    this.clear();
    this.result = result;
    this.plot.replaceChildren(target);
    this.plot.querySelector('svg')?.setAttribute('aria-hidden', 'true');
    this.after();
  }

  clear() {
    this.result?.finalize();
    this.result = null;
  }

  remove() {
    this.turn++;
    this.clear();
    charts.delete(this);
    nearWindow.unobserve(this.host);
    widthWatch.unobserve(this.host);
    this.plot.remove();
  }

  /** Where the first view of the chart lies in the window; null before it is drawn. */
  frame(view = 0) {
    const background = (group) => this.plot.querySelector(`.mark-group.${group} > g > path.background`);
    const path = background(`concat_${view}_group`) ?? background('role-frame');
    return path ? path.getBoundingClientRect() : null;
  }
}

function touchCharts() {
  for (const chart of charts) chart.touch();
}

let idle = false;

/** Draws what is out of date one by one while nothing else is to do. */
function startIdleDrawing() {
  if (idle || charts.size > eagerCharts) return;
  idle = true;
  const soon = {timeout: 200};
  const later = window.requestIdleCallback ? (work) => window.requestIdleCallback(work, soon) : (work) => setTimeout(work, 50);
  const next = async () => {
    const chart = [...charts].find((one) => !one.drawn && one.host.clientWidth > 0);
    idle = Boolean(chart);
    if (!chart) return;
    const before = performance.now();
    await chart.refresh();
    setTimeout(() => later(next), performance.now() - before);  // half of the time is the reader's
  };
  later(next);
}

window.addEventListener('beforeprint', () => {
  if (charts.size <= eagerCharts) for (const chart of charts) chart.refresh();
});

/**
 * Lets the reader walk along a chart's horizontal axis, by pointer or arrow keys. axis() gives {domain, log, places, tell}:
 * places are the data's own positions, tell(index) gives [title, rows] for the tooltip.
 */
function readable(chart, axis) {
  const line = element('div', {class: 'crosshair', hidden: true});
  chart.host.append(line);
  chart.host.tabIndex = 0;
  let at = -1;

  const show = (index, y) => {
    const {domain, log, places, tell} = axis();
    const frame = chart.frame();
    if (!frame || places.length === 0) return;
    at = Math.max(0, Math.min(places.length - 1, index));
    const f = log ? Math.log : (v) => v;
    const share = (f(places[at]) - f(domain[0])) / (f(domain[1]) - f(domain[0]));
    const host = chart.host.getBoundingClientRect();
    const x = frame.left + share * frame.width;
    line.hidden = false;
    line.style.cssText = `left:${x - host.left}px;top:${frame.top - host.top}px;height:${frame.height}px`;
    showTooltip(...tell(at), x, y ?? frame.top + 8);
  };
  const hide = () => {
    line.hidden = true;
    hideTooltip();
  };
  const nearest = (clientX) => {
    const {domain, log, places} = axis();
    const frame = chart.frame();
    if (!frame) return -1;
    const f = log ? Math.log : (v) => v;
    const value = f(domain[0]) + ((clientX - frame.left) / frame.width) * (f(domain[1]) - f(domain[0]));
    let best = -1;
    places.forEach((place, index) => {
      if (best < 0 || Math.abs(f(place) - value) < Math.abs(f(places[best]) - value)) best = index;
    });
    return best;
  };
  chart.host.addEventListener('pointermove', (event) => show(nearest(event.clientX), event.clientY));
  chart.host.addEventListener('pointerdown', (event) => show(nearest(event.clientX), event.clientY));
  chart.host.addEventListener('pointerleave', hide);
  chart.host.addEventListener('blur', hide);
  chart.host.addEventListener('keydown', (event) => {
    const move = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    if (!move) return;
    event.preventDefault();
    show(at + move);
  });
}
