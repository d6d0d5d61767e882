// One box that follows the pointer.

const tooltipBox = element('div', {class: 'tooltip', role: 'status', hidden: true});
document.body.append(tooltipBox);

/** Shows a title and rows [place of a policy or null, name, value] near a point of the window. */
function showTooltip(title, rows, x, y) {
  const body = rows.map(([place, name, value]) =>
    element('tr', {}, element('td', {}, ...(place === null ? [] : [swatch(place)]), name), element('td', {}, value)));
  tooltipBox.replaceChildren(element('strong', {}, title), element('table', {}, ...body));
  tooltipBox.hidden = false;
  const {width, height} = tooltipBox.getBoundingClientRect();
  const left = x + 14 + width > window.innerWidth - 4 ? x - 14 - width : x + 14;
  const top = Math.min(y + 12, window.innerHeight - height - 4);
  tooltipBox.style.transform = `translate(${Math.max(4, left)}px, ${Math.max(4, top)}px)`;
}

function hideTooltip() {
  tooltipBox.hidden = true;
}

/** For vega-embed: what a mark's tooltip channel holds, shown in our box. */
function vegaTooltip(_, event, item, value) {
  if (!value) return hideTooltip();
  const rows = Object.entries(value).map(([name, text]) => [null, name, String(text)]);
  return showTooltip('', rows, event.clientX, event.clientY);
}

window.addEventListener('scroll', hideTooltip, {passive: true});
window.addEventListener('keydown', (event) => {
  if (event.key === 'Escape') hideTooltip();
});
