// What all figures share: choices above, buttons beneath, a table of what is drawn.

const mostInKey = 12;  // policies, before the key scrolls
const tableRows = 300;  // that a browser shows without pain; the CSV has all

/** A row of buttons of which one is pressed. options: [[value, label, help]]. */
function segmented(label, options, current, choose) {
  const buttons = options.map(([value, text, help]) =>
    element('button', {type: 'button', title: help, 'aria-pressed': String(value === current()), onclick: () => choose(value)}, text));
  onChange(() => options.forEach(([value], index) => buttons[index].setAttribute('aria-pressed', String(value === current()))));
  return element('div', {class: 'segmented', role: 'group', 'aria-label': label}, ...buttons);
}

function metricSelect(metrics) {
  const select = element('select', {'aria-label': 'Metric', onchange: () => change({metric: Number(select.value)})},
    ...metrics.map((index) => element('option', {value: index}, `${data.metrics[index].name}: ${data.metrics[index].title}`)));
  const help = element('span', {class: 'help'});
  const update = () => {
    if (metrics.includes(state.metric)) select.value = state.metric;
    help.textContent = data.metrics[Number(select.value)]?.help ?? '';
  };
  onChange(update);
  update();
  return element('label', {class: 'choice'}, element('span', {class: 'label'}, 'Metric'), select, help);
}

function startChoice(starts) {
  if (starts.length < 2) return '';
  const options = starts.map((index) => [index, data.starts[index].name, data.starts[index].title]);
  return element('div', {class: 'choice'}, element('span', {class: 'label'}, 'Start'),
    segmented('Start', options, () => state.start, (start) => change({start})));
}

/** The key to the lines; each entry hides or shows its policy everywhere. A long one can be emptied and filled at once. */
function policyKey(policies) {
  const toggle = (policy) => {
    const hidden = new Set(state.hidden);
    if (!hidden.delete(policy)) hidden.add(policy);
    change({hidden});
  };
  const buttons = policies.map((policy) =>
    element('button', {type: 'button', 'data-policy': placeOf(policy), title: data.policies[policy].kind, onclick: () => toggle(policy)},
      swatch(placeOf(policy)), element('span', {}, data.policies[policy].name)));
  const update = () => buttons.forEach((button, index) =>
    button.setAttribute('aria-pressed', String(!state.hidden.has(policies[index]))));
  onChange(update);
  update();
  const key = element('div', {class: 'key-row', role: 'group', 'aria-label': 'Policies shown'}, ...buttons);
  if (policies.length <= mostInKey) return key;
  key.classList.add('crowded');
  key.tabIndex = 0;
  const those = (label, hidden) => element('button', {type: 'button', onclick: () => change({hidden: new Set(hidden)})}, label);
  return element('div', {class: 'long-key'},
    element('div', {class: 'choice'}, element('span', {class: 'label'}, `${policies.length} policies`),
      those('First 8', policies.slice(shownAtFirst)), those('All', []), those('None', policies)), key);
}

/** The places of a sorted list of numbers without repetition. */
function distinct(values) {
  return [...new Set(values)].sort((a, b) => a - b);
}

function tableOf(rows) {
  const names = rows.length > 0 ? Object.keys(rows[0]) : [];
  const cell = (value) => element('td', {class: typeof value === 'number' ? 'number' : null}, typeof value === 'number' ? pretty(value) : value ?? '–');
  const body = rows.slice(0, tableRows).map((row) => element('tr', {}, ...names.map((name) => cell(row[name]))));
  const table = element('table', {}, element('thead', {}, element('tr', {}, ...names.map((name) => element('th', {scope: 'col', class: typeof rows[0][name] === 'number' ? 'number' : null}, name)))),
    element('tbody', {}, ...body));
  const more = rows.length > tableRows ? [element('p', {class: 'note'}, `${rows.length - tableRows} rows more are in the CSV.`)] : [];
  return element('div', {class: 'scroll data-table', tabindex: 0, role: 'region', 'aria-label': 'Data of the figure'}, table, ...more);
}

function commandList(commands) {
  const lines = commands.filter(([, command]) => command).map(([title, command]) => {
    const code = element('code', {}, command);
    return element('div', {class: 'command'}, ...(title ? [element('small', {}, title)] : []), code,
      element('button', {type: 'button', onclick: (event) => copyText(command, event.currentTarget)}, 'Copy'));
  });
  return element('div', {class: 'commands'}, ...(lines.length > 0 ? lines : [element('p', {class: 'note'}, 'No command is known.')]));
}

/**
 * Adds the buttons of a figure. parts: {name, rows(), spec(), commands()}: rows for CSV and table, the whole figure as one
 * Vega-Lite specification, [[title, command]].
 */
function addTools(figure, parts) {
  const name = `${data.name}-${parts.name}`;
  const drawer = element('div', {class: 'drawer', 'aria-live': 'polite'});
  let open = '';
  const show = (what, content) => {
    open = open === what ? '' : what;
    drawer.replaceChildren(...(open ? [content()] : []));
    for (const button of tools.querySelectorAll('[aria-expanded]')) {
      button.setAttribute('aria-expanded', String(button.dataset.opens === open));
    }
  };
  const opener = (what, content) => element('button',
    {type: 'button', 'aria-expanded': 'false', 'data-opens': what, onclick: () => show(what, content)}, what);
  const giver = (label, title, give) => element('button', {type: 'button', title, onclick: give}, label);
  const tools = element('div', {class: 'tools', role: 'group', 'aria-label': 'This figure as'},
    opener('Table', () => tableOf(parts.rows())),
    giver('CSV', 'The numbers of this figure, as shown', () => download(fileName(name, 'csv'), toCsv(parts.rows()), 'text/csv')),
    giver('Vega-Lite', 'The specification of this figure, with its data', () => downloadSpec(parts.spec(), name)),
    giver('SVG', 'This figure as a vector drawing', () => downloadSvg(parts.spec(), name)),
    giver('PNG', 'This figure as an image', () => downloadPng(parts.spec(), name)),
    opener('Command', () => commandList(parts.commands())));
  onChange(() => {
    if (open === 'Table') drawer.replaceChildren(tableOf(parts.rows()));
  });
  figure.querySelector('figcaption').after(tools, drawer);
}
