// Colours, dashes and markers of the policies, the look of the charts, light and dark.

const colourCount = 8;
const dashes = [[], [7, 3], [2, 2.5], [9, 3, 2, 3], [5, 2], [1, 2.5], [12, 4], [6, 2, 2, 2]];
const shapes = ['circle', 'square', 'triangle-up', 'diamond', 'cross', 'triangle-down', 'triangle-right', 'stroke'];

/** Dash and marker of the policy at a place; past eight places colours repeat with the next pair. */
function styleOf(place) {
  const turn = place + Math.floor(place / colourCount);
  return {dash: dashes[turn % dashes.length], shape: shapes[turn % shapes.length]};
}

function cssColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/**
 * How charts get their colours: on screen as CSS variables, so that a change of theme or printing needs no drawing; in an
 * exported file as the colours themselves.
 */
const onScreen = {colour: (name) => `var(${name})`};
const inFile = {colour: cssColour};

function policyColour(look, place) {
  return look.colour(`--p${place % colourCount}`);
}

function chartConfig(look) {
  const ink = look.colour('--ink-2');
  const rule = look.colour('--rule');
  return {
    background: look === inFile ? look.colour('--paper') : null,
    aria: false,  // a chart speaks through its host's label, not mark by mark
    font: 'Inter, system-ui, sans-serif',
    view: {stroke: null},
    axis: {
      labelColor: ink, titleColor: ink, labelFontSize: 10.5, titleFontSize: 11, titleFontWeight: 500, titlePadding: 5,
      gridColor: rule, domainColor: look.colour('--rule-2'), tickColor: look.colour('--rule-2'), tickSize: 4,
      labelPadding: 3, labelFlush: false,
    },
    title: {color: look.colour('--ink'), fontSize: 12, fontWeight: 600, anchor: 'start', subtitleColor: ink},
    legend: {labelColor: ink, titleColor: ink, labelFontSize: 11, titleFontSize: 11, titleFontWeight: 500},
    concat: {spacing: 8},
  };
}

/** The scales that give each policy {name, place} its colour, dash and marker, as Vega-Lite encodings. */
function policyEncoding(look, policies, legend) {
  const domain = policies.map((policy) => policy.name);
  const title = legend ? {title: 'policy'} : null;
  const scale = (range) => ({domain, range});
  return {
    color: {field: 'policy', type: 'nominal', legend: title, scale: scale(policies.map((p) => policyColour(look, p.place)))},
    dash: {field: 'policy', type: 'nominal', legend: title, scale: scale(policies.map((p) => styleOf(p.place).dash))},
    shape: {field: 'policy', type: 'nominal', legend: title, scale: scale(policies.map((p) => styleOf(p.place).shape))},
  };
}

const markerPaths = {
  circle: 'M-3 0a3 3 0 1 0 6 0a3 3 0 1 0 -6 0',
  square: 'M-2.8 -2.8H2.8V2.8H-2.8Z',
  'triangle-up': 'M0 -3.6L3.6 2.8H-3.6Z',
  diamond: 'M0 -4L3.4 0L0 4L-3.4 0Z',
  cross: 'M-1.2 -3.5H1.2V-1.2H3.5V1.2H1.2V3.5H-1.2V1.2H-3.5V-1.2H-1.2Z',
  'triangle-down': 'M0 3.6L3.6 -2.8H-3.6Z',
  'triangle-right': 'M3.6 0L-2.8 3.6V-3.6Z',
  stroke: 'M-3.5 -0.8H3.5V0.8H-3.5Z',
};

/** A short piece of the line of the policy at a place, with its marker. */
function swatch(place) {
  const {dash, shape} = styleOf(place);
  return svgElement('svg', {class: 'swatch', 'data-policy': place, width: 26, height: 10, viewBox: '0 0 26 10', 'aria-hidden': 'true'},
    svgElement('line', {x1: 0, x2: 26, y1: 5, y2: 5, 'stroke-dasharray': dash.join(' ')}),
    svgElement('path', {d: markerPaths[shape], transform: 'translate(13 5)'}));
}

const themes = ['auto', 'light', 'dark'];
const themeSigns = {auto: '◐', light: '○', dark: '●'};

function currentTheme() {
  return document.documentElement.dataset.theme ?? 'auto';
}

function setTheme(theme) {
  if (theme === 'auto') delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  try {
    localStorage.setItem('gust-theme', theme);
  } catch {
    // the choice then holds for this visit only
  }
}

function startThemeButton() {
  const button = document.getElementById('theme');
  const label = () => {
    const theme = currentTheme();
    button.textContent = themeSigns[theme];
    button.title = `Theme: ${theme}`;
    button.setAttribute('aria-label', `Theme: ${theme}. Change`);
  };
  button.hidden = false;
  button.addEventListener('click', () => {
    setTheme(themes[(themes.indexOf(currentTheme()) + 1) % themes.length]);
    label();
  });
  label();
}
