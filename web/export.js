// What a figure gives away: CSV, its Vega-Lite specification, SVG, PNG.

/** A name that any file system takes. */
function fileName(name, ending) {
  const slug = name.normalize('NFKD').replace(/[^A-Za-z0-9]+/g, '-').replace(/^-+|-+$/g, '').slice(0, 80);
  return `${slug || 'figure'}.${ending}`;
}

function download(name, content, type) {
  const url = content instanceof Blob ? URL.createObjectURL(content) : URL.createObjectURL(new Blob([content], {type}));
  const link = element('a', {href: url, download: name});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

function csvField(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return '';
  const text = String(value);
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** Rows (objects with equal keys) as CSV with a header. */
function toCsv(rows) {
  if (rows.length === 0) return '';
  const names = Object.keys(rows[0]);
  return [names, ...rows.map((row) => names.map((name) => row[name]))]
    .map((fields) => fields.map(csvField).join(',')).join('\r\n') + '\r\n';
}

/** A view of a specification that no window shows. */
function hiddenView(spec) {
  const compiled = vegaLite.compile({...spec, config: chartConfig(inFile)}).spec;
  return new vega.View(vega.parse(compiled), {renderer: 'none'});
}

async function downloadSvg(spec, name) {
  download(fileName(name, 'svg'), await hiddenView(spec).toSVG(), 'image/svg+xml');
}

async function downloadPng(spec, name) {
  const canvas = await hiddenView(spec).toCanvas(2);
  canvas.toBlob((blob) => download(fileName(name, 'png'), blob), 'image/png');
}

function downloadSpec(spec, name) {
  const text = JSON.stringify({...spec, config: chartConfig(inFile)}, null, 1);
  download(fileName(name, 'vl.json'), text, 'application/json');
}

async function copyText(text, button) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = element('textarea', {class: 'hidden'});
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
  const label = button.textContent;
  button.textContent = 'Copied';
  setTimeout(() => { button.textContent = label; }, 1500);
}
