// Draws `sets` (objects as of `ccst analyze --json`), `table` and `pictures`.
'use strict';
const colors = ['#1f6fb4', '#d9632a', '#2f9e5b', '#8a4fb8', '#b3913a', '#c03a5b', '#4a5568', '#1aa3a3'];
const colorOf = i => colors[i % colors.length];

function add(parent, name, text) {
  const element = document.createElement(name);
  if (text !== undefined) element.textContent = text;
  parent.appendChild(element);
  return element;
}

function drawTable() {
  const root = document.getElementById('table');
  const head = add(add(root, 'thead'), 'tr');
  add(head, 'th', '');
  sets.forEach((set, i) => { add(head, 'th', set.name).style.color = colorOf(i); });
  const body = add(root, 'tbody');
  const counts = add(body, 'tr');
  add(counts, 'th', 'samples (sets)');
  for (const set of sets) add(counts, 'td', `${set.count} (${set.sets ?? 1})`);
  for (const line of table) {
    const row = add(body, 'tr');
    add(row, 'th', line.title);
    for (const cell of line.cells) {
      const td = add(row, 'td', cell ? cell.text : '–');
      if (cell && cell.best) td.className = 'best';
    }
  }
}

// One chart with a curve for every set that has one.
function draw(parentId, caption, curveOf, x, y, { steps = false } = {}) {
  const datasets = sets.flatMap((set, i) => {
    const curve = curveOf(set);
    if (!curve || !curve.x.length) return [];
    const data = curve.x.map((at, k) => ({ x: at, y: curve.y[k] }));
    return [{ label: set.name, data, borderColor: colorOf(i), backgroundColor: colorOf(i),
              borderWidth: 1.5, pointRadius: 0, stepped: steps ? 'middle' : false }];
  });
  if (!datasets.length) return;
  const figure = add(document.getElementById(parentId), 'figure');
  add(figure, 'figcaption', caption);
  const axis = (title, range = {}) =>
    ({ type: 'linear', title: { display: true, text: title }, ...range });
  new Chart(add(figure, 'canvas'), {
    type: 'line', data: { datasets },
    options: { animation: false, parsing: false, normalized: true, aspectRatio: 1.7,
               interaction: { mode: 'nearest', axis: 'x', intersect: false },
               scales: { x: axis(...x), y: axis(...y) },
               plugins: { legend: { labels: { boxWidth: 18, boxHeight: 2 } } } },
  });
}

function drawPictures() {
  pictures.forEach((picture, i) => {
    if (!picture) return;
    const figure = add(document.getElementById('pictures'), 'figure');
    const image = add(figure, 'img');
    image.src = picture;
    image.alt = `${sets[i].name}: samples on the surface`;
    add(figure, 'figcaption', sets[i].name);
  });
}

drawTable();
draw('curves', 'Radial mean of the differences: density of samples at a distance over the mean',
     set => set.radial_mean, ['distance / spacing', { min: 0, max: 4 }], ['density', { min: 0 }]);
draw('curves', 'Anisotropy: noise lies at −10 log10(sets) dB, directions rise above it',
     set => set.anisotropy, ['distance / spacing', { min: 0, max: 4 }],
     ['dB', { suggestedMin: -15, suggestedMax: 5 }]);
draw('curves', 'Radial power spectrum', set => set.power_spectrum,
     ['frequency / root of density', { min: 0, max: 4 }], ['power', { min: 0 }]);
const histogram = key => set => set.histograms && set.histograms[key];
draw('histograms', 'Distance to the nearest sample', histogram('nearest_distance'),
     ['distance / spacing', { min: 0, max: 1.2 }], ['share'], { steps: true });
draw('histograms', 'Capacity of triangles over the mean', histogram('capacity'),
     ['capacity', { min: 0, max: 2 }], ['share'], { steps: true });
draw('histograms', 'Angles of triangles', histogram('angle'), ['degrees', { min: 0, max: 150 }],
     ['share'], { steps: true });
draw('histograms', 'Valences', histogram('valence'), ['edges', { min: 2, max: 11 }], ['share'],
     { steps: true });
drawPictures();
document.body.dataset.ready = 'true';
