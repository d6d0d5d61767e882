// Numbers as a reader wants them, and new elements.

/** A number for a reader: four significant digits, a true minus sign. */
function pretty(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  const size = Math.abs(value);
  const text = size >= 1e6 || (size > 0 && size < 1e-4) ? value.toExponential(2) : String(Number(value.toPrecision(4)));
  return text.replace('-', '−');
}

/** A count of steps: 60 k, 1 M. */
function prettyCount(value) {
  if (value >= 1e6) return `${Number((value / 1e6).toPrecision(3))} M`;
  return value >= 1e3 ? `${Number((value / 1e3).toPrecision(3))} k` : String(value);
}

function withUnit(text, unit) {
  return unit ? `${text} ${unit}` : text;
}

function axisTitle(text, unit) {
  return unit ? `${text} [${unit}]` : text;
}

/** The number, or null where it is none that can be drawn. */
function finite(value) {
  return Number.isFinite(value) ? value : null;
}

/** [smallest, largest] of the finite numbers; null where there is none. */
function extent(values) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value === null || !Number.isFinite(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : null;
}

/** An interval with some air, never empty. */
function padded([low, high], share = 0.05) {
  const air = (high - low) * share || Math.abs(high) * share || 1;
  return [low - air, high + air];
}

/** A new element: element('button', {type: 'button', onclick}, 'text', child). Texts are never read as HTML. */
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else made.setAttribute(name, value === true ? '' : value);
  }
  made.append(...children);
  return made;
}

function svgElement(tag, attributes = {}, ...children) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}
