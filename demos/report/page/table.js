// Tables that the reader sorts, by the heads of their columns, and filters.
(() => {
  'use strict';
  const kUnits = {n: 1e-9, '\u00b5': 1e-6, m: 1e-3, '': 1};

  // A number where the cell holds one ("1.24 \u00b5s" is 1.24e-6), else its words.
  function value(cell) {
    if (cell.dataset.value !== undefined) return Number(cell.dataset.value);
    const text = cell.textContent.trim();
    const found = /^(-?[\d.]+(?:e[-+]?\d+)?)(?: (n|\u00b5|m)?[smJ])?$/.exec(text);
    return found ? Number(found[1]) * kUnits[found[2] || ''] : text;
  }

  function compare(a, b) {
    if (typeof a === 'number' && typeof b === 'number') return a - b;
    if (typeof a === 'number' || typeof b === 'number') return typeof a === 'number' ? 1 : -1;
    return a.localeCompare(b, 'en', {numeric: true});
  }

  function startTable(table) {
    const body = table.tBodies[0];
    const rows = [...body.rows];
    const heads = [...table.tHead.rows[0].cells];
    heads.forEach((head, column) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.className = 'sort';
      button.append(...head.childNodes);
      head.append(button);
      head.setAttribute('aria-sort', 'none');
      button.addEventListener('click', () => {
        // Numbers: the largest first. A third press gives the order of the program back.
        const numeric = rows.some(row => typeof value(row.cells[column]) === 'number');
        const turns = numeric ? ['descending', 'ascending', 'none'] : ['ascending', 'descending', 'none'];
        const next = turns[(turns.indexOf(head.getAttribute('aria-sort')) + 1) % 3];
        for (const other of heads) other.setAttribute('aria-sort', 'none');
        head.setAttribute('aria-sort', next);
        const sign = next === 'descending' ? -1 : 1;
        const sorted = next === 'none' ? rows : [...rows].sort((a, b) =>
          sign * compare(value(a.cells[column]), value(b.cells[column])));
        body.append(...sorted);
      });
    });
    if (rows.length < 12) return;
    const label = document.createElement('label');
    label.className = 'filter';
    const field = document.createElement('input');
    field.type = 'search';
    const count = document.createElement('output');
    label.append('Rows with ', field, ' ', count);
    table.closest('.scroll').before(label);
    const show = () => {
      const words = field.value.toLowerCase().split(/\s+/).filter(word => word);
      let left = 0;
      for (const row of rows) {
        const text = row.textContent.toLowerCase();
        const cells = [...row.cells].map(cell => cell.textContent.toLowerCase());
        row.hidden = !words.every(word => isNaN(word) ? text.includes(word) : cells.includes(word));
        left += row.hidden ? 0 : 1;
      }
      count.textContent = left + ' of ' + rows.length;
    };
    field.addEventListener('input', show);
    show();
  }

  document.querySelectorAll('table.sortable').forEach(startTable);
})();
