"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const $ = (id) => document.getElementById(id);
  const state = { view: "table", board: 0, sort: "mae", down: false, filter: "", cost: "latency", run: "", columns: null };
  const charts = [];

  // Every text goes in as text: nothing from a record is ever read as markup.
  const make = (tag, words, attributes = {}) => {
    const node = document.createElement(tag);
    if (words !== undefined && words !== null) node.textContent = words;
    for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
    return node;
  };
  const fixed = (value, digits) => (value === null || value === undefined ? "–" : value.toFixed(digits));
  const three = (value) => (value === null || value === undefined ? "–"
    : Math.abs(value) >= 1000 ? Math.round(value).toLocaleString("en") : String(Number(value.toPrecision(3))));
  const ends = (one, digits) => (one && one.low !== null && one.high !== null
    ? `[${fixed(one.low, digits)}, ${fixed(one.high, digits)}]` : "");
  const get = (one, ...path) => path.reduce((at, name) => (at === null || at === undefined ? null : at[name]), one);
  const nameOf = (entry) => `${entry.model}/${entry.backend}`;

  const interval = (path, digits) => ({
    value: (entry) => get(entry, ...path, "value"),
    cell: (entry) => [fixed(get(entry, ...path, "value"), digits), ends(get(entry, ...path), digits)],
  });
  const plain = (name) => ({ value: (entry) => entry[name], cell: (entry) => [three(entry[name]), ""] });
  const COLUMNS = [
    { id: "rank", title: "Rank", shown: true, value: (e) => e.best_rank ?? null,
      cell: (e) => [e.best_rank ? (e.best_rank === e.worst_rank ? `${e.best_rank}` : `${e.best_rank}–${e.worst_rank}`) : "–", ""] },
    { id: "model", title: "Model", text: true, shown: true, link: true, value: (e) => e.model, cell: (e) => [e.floor ? `${e.model} (floor)` : e.model, ""] },
    { id: "backend", title: "Backend", text: true, shown: true, value: (e) => e.backend, cell: (e) => [e.backend, ""] },
    { id: "mae", title: "NLoS MAE (m)", shown: true, ...interval(["nlos", "mae_m"], 4) },
    { id: "ties", title: "Ties", text: true, shown: true, value: (e) => e.ties ?? "", cell: (e) => [e.ties ?? "–", ""] },
    { id: "r2", title: "NLoS R²", shown: true, ...interval(["nlos", "r2"], 3) },
    { id: "sigma", title: "NLoS σ (m)", shown: false, ...interval(["nlos", "sigma_m"], 4) },
    { id: "los", title: "LoS MAE (m)", shown: true, ...interval(["los", "mae_m"], 4) },
    { id: "harm", title: "LoS after - before (m)", shown: false, harm: true,
      value: (e) => (e.los ? e.los.mae_m.value - e.los.raw_mae_m : null),
      cell: (e) => [e.los ? fixed(e.los.mae_m.value - e.los.raw_mae_m, 4) : "–", ""] },
    { id: "latency", title: "Latency, batch 1 (µs)", shown: true, value: (e) => get(e, "latency_us", "value"),
      cell: (e) => [three(get(e, "latency_us", "value")) + (get(e, "latency_us", "unstable") ? " †" : ""), ends(e.latency_us, 1)] },
    { id: "latency4", title: "Latency, batch 4 (µs)", shown: false, value: (e) => get(e, "latency4_us", "value"),
      cell: (e) => [three(get(e, "latency4_us", "value")), ends(e.latency4_us, 1)] },
    { id: "file", title: "File (kB)", shown: true, ...plain("file_kb") },
    { id: "weights", title: "Weights (kB)", shown: false, ...plain("weights_kb") },
    { id: "parameters", title: "Parameters", shown: false, ...plain("parameters") },
    { id: "macs", title: "Multiply-adds", shown: false, ...plain("macs") },
    { id: "memory", title: "Peak memory (MB)", shown: false, ...plain("memory_mb") },
    { id: "throughput", title: "Throughput (rows/s)", shown: false, ...plain("rows_per_s") },
    { id: "integer", title: "Integer kernels", text: true, shown: false, value: (e) => e.integer_kernels, cell: (e) => [e.integer_kernels || "–", ""] },
    { id: "seeds", title: "Seeds", shown: false, ...plain("seeds") },
  ];

  const board = () => data.boards[state.board];
  const shown = () => COLUMNS.filter((one) => (state.columns ? state.columns.includes(one.id) : one.shown));
  const error = (entry) => get(entry, "nlos", "mae_m", "value") ?? get(entry, "los", "mae_m", "value");

  function entries() {
    const words = state.filter.toLowerCase().split(/\s+/).filter(Boolean);
    const kept = board().entries.filter((one) => words.every((word) => nameOf(one).toLowerCase().includes(word)));
    const column = COLUMNS.find((one) => one.id === state.sort) ?? COLUMNS[3];
    const missing = (value) => value === null || value === undefined || value === "";
    return kept.sort((a, b) => {
      const [x, y] = [column.value(a), column.value(b)];
      if (missing(x) || missing(y)) return missing(x) - missing(y);
      const order = typeof x === "string" ? x.localeCompare(y) : x - y;
      return state.down ? -order : order;
    });
  }

  function readHash() {
    const asked = new URLSearchParams(location.hash.slice(1));
    const number = Number(asked.get("board"));
    state.board = Number.isInteger(number) && number >= 0 && number < data.boards.length ? number : 0;
    const views = [...document.querySelectorAll("[data-section]")].map((one) => one.dataset.section);
    state.view = views.includes(asked.get("view")) ? asked.get("view") : "table";
    state.sort = COLUMNS.some((one) => one.id === asked.get("sort")) ? asked.get("sort") : "mae";
    state.down = asked.get("down") === "1";
    state.filter = asked.get("filter") ?? "";
    state.run = asked.get("run") ?? "";
    state.cost = asked.get("cost") ?? "latency";
    state.columns = asked.has("columns") ? asked.get("columns").split(",") : null;
  }
  const hash = (changes = {}) => {
    const all = { ...state, ...changes };
    const words = new URLSearchParams({ view: all.view, board: all.board, sort: all.sort });
    if (all.down) words.set("down", "1");
    if (all.filter) words.set("filter", all.filter);
    if (all.view === "run") words.set("run", all.run);
    if (all.cost !== "latency") words.set("cost", all.cost);
    if (all.columns) words.set("columns", all.columns.join(","));
    return `#${words}`;
  };
  const go = (changes) => { Object.assign(state, changes); history.replaceState(null, "", hash()); draw(); };

  function drawTable() {
    const one = board();
    const table = $("results");
    table.caption.textContent = `${one.data}, split ${one.split}`;
    if (one.simulated) table.caption.append(" ", make("span", "SIMULATED", { class: "simulated" }));
    const head = make("tr");
    for (const column of shown()) {
      const sorted = column.id === state.sort;
      const cell = make("th", null, { scope: "col", class: column.text ? "text" : "", "aria-sort": sorted ? (state.down ? "descending" : "ascending") : "none" });
      const button = make("button", column.title + (sorted ? (state.down ? " ▼" : " ▲") : ""), { type: "button", "data-sort": column.id });
      button.addEventListener("click", () => {
        go({ sort: column.id, down: sorted ? !state.down : false });
        document.querySelector(`[data-sort="${column.id}"]`)?.focus();
      });
      cell.append(button);
      head.append(cell);
    }
    table.tHead.replaceChildren(head);
    table.tBodies[0].replaceChildren(...entries().map(row));
  }
  function row(entry) {
    const line = make("tr");
    for (const column of shown()) {
      const [words, small] = column.cell(entry);
      const cell = make(column.id === "model" ? "th" : "td", null, { class: column.text ? "text" : "" });
      if (column.id === "model") cell.setAttribute("scope", "row");
      if (column.link) cell.append(make("a", words, { href: hash({ view: "run", run: nameOf(entry) }) }));
      else cell.append(words);
      if (column.harm && column.value(entry) > 0) cell.classList.add("harm");
      if (small) cell.append(make("small", small));
      line.append(cell);
    }
    return line;
  }

  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  function plot(canvas, kind, sets, x, y, more = {}) {
    if (typeof Chart === "undefined") return;
    const axis = (title, extra = {}) => ({ title: { display: true, text: title, color: colour("--ink") }, ticks: { color: colour("--ink") }, grid: { color: colour("--line") }, ...extra });
    charts.push(new Chart(canvas, {
      type: kind,
      data: { labels: more.labels, datasets: sets },
      options: { animation: false, maintainAspectRatio: false, responsive: true,
        plugins: { legend: { labels: { color: colour("--ink") } }, tooltip: { callbacks: more.tooltip ? { label: more.tooltip } : {} } },
        scales: { x: axis(x, more.x), y: axis(y, more.y) } },
    }));
  }

  const COSTS = () => {
    const costs = [
      { id: "latency", title: "latency, batch 1 (µs), measured", value: (e) => get(e, "latency_us", "value") },
      { id: "file", title: "file (kB)", value: (e) => e.file_kb },
      { id: "macs", title: "multiply-adds", value: (e) => e.macs },
    ];
    const devices = new Map();
    for (const entry of board().entries) for (const one of entry.devices) if (one.latency_us) devices.set(one.device, one.how);
    for (const [device, how] of devices) {
      const find = (entry) => entry.devices.find((one) => one.device === device);
      costs.push({ id: `latency-${device}`, title: `latency on ${device} (µs), ${how}`, value: (e) => get(find(e), "latency_us", "value") });
      costs.push({ id: `energy-${device}`, title: `energy on ${device} (mJ), ${how}`, value: (e) => get(find(e), "energy_mj", "value") });
    }
    return costs.filter((cost) => board().entries.some((one) => cost.value(one) !== null && cost.value(one) !== undefined));
  };
  function front(points) {
    const order = [...points].sort((a, b) => a.x - b.x || a.y - b.y);
    let best = Infinity;
    return order.filter((one) => (one.y < best ? ((best = one.y), true) : false));
  }
  function drawExplorer() {
    const costs = COSTS();
    const cost = costs.find((one) => one.id === state.cost) ?? costs[0];
    $("cost").replaceChildren(...costs.map((one) => make("option", one.title, { value: one.id })));
    if (!cost) { $("front-text").textContent = "No cost is known here."; return; }
    $("cost").value = cost.id;
    const points = entries().filter((one) => !one.floor && error(one) !== null && cost.value(one) > 0)
      .map((one) => ({ x: cost.value(one), y: error(one), name: nameOf(one) }));
    const best = points.length > 1 ? front(points) : [];
    const sets = [{ label: "models", data: points, backgroundColor: colour("--before"), pointRadius: 5 }];
    if (best.length > 1) sets.unshift({ label: "front: none is better in both", data: best, showLine: true, borderColor: colour("--accent"), backgroundColor: colour("--accent"), pointRadius: 6, pointStyle: "rectRot" });
    plot($("front"), "scatter", sets, cost.title, "MAE after correction (m)", {
      x: { type: "logarithmic" }, tooltip: (item) => `${item.raw.name}: ${three(item.raw.x)}, ${fixed(item.raw.y, 4)} m` });
    $("front-text").textContent = best.length > 1 ? `On the front: ${best.map((one) => `${one.name} (${fixed(one.y, 4)} m)`).join(", ")}.`
      : "Fewer than two points: no front.";
  }

  function chartBox(title) {
    const box = make("div", null, { class: "small" });
    const area = make("div", null, { class: "plot" });
    const canvas = make("canvas", null, { role: "img", "aria-label": title });
    area.append(canvas);
    box.append(make("h3", title), area);
    return [box, canvas];
  }
  const bars = (label, values, name) => ({ label, data: values, backgroundColor: colour(name), barPercentage: 1, categoryPercentage: 0.9 });
  function drawRun() {
    const section = $("view-run");
    const entry = board().entries.find((one) => nameOf(one) === state.run);
    if (!entry) { section.replaceChildren(make("p", "No such run on this board.")); return; }
    const list = make("ul");
    const facts = [
      ["NLoS MAE", get(entry, "nlos", "mae_m", "value"), "m, by bootstrap over links", get(entry, "nlos", "mae_m")],
      ["LoS MAE", get(entry, "los", "mae_m", "value"), "m", get(entry, "los", "mae_m")],
    ];
    for (const [name, value, unit, one] of facts) if (value !== null) list.append(make("li", `${name} ${fixed(value, 4)} ${unit} ${ends(one, 4)}`));
    if (entry.latency_us) list.append(make("li", `latency ${three(entry.latency_us.value)} µs, batch 1, measured on ${board().machine ?? "an unknown machine"}${entry.latency_us.unstable ? " (unstable)" : ""}`));
    if (entry.file_kb !== null) list.append(make("li", `${three(entry.file_kb)} kB on disk, ${three(entry.parameters)} parameters, ${three(entry.macs)} multiply-adds (counted from the graph)`));
    if (entry.precision) list.append(make("li", `precision: ${entry.precision}`));
    for (const note of entry.notes) list.append(make("li", note));
    const grid = make("div", null, { class: "grid" });
    section.replaceChildren(make("h2", `${nameOf(entry)} on ${board().data}${board().simulated ? " (SIMULATED)" : ""}`),
      make("a", "Back to the table", { href: hash({ view: "table" }) }), list, grid);
    const left = entry.residuals;
    const pending = [];
    const add = (title, ...rest) => { const [box, canvas] = chartBox(title); grid.append(box); pending.push(() => plot(canvas, ...rest)); };
    if (left) {
      const middle = (edges) => edges.slice(1).map((edge, at) => fixed((edge + edges[at]) / 2, 2));
      add("Errors before and after", "bar", [bars("before", left.histogram.before, "--before"), bars("after", left.histogram.after, "--after")], "error (m)", "rows", { labels: middle(left.histogram.edges_m) });
      for (const [name, title] of [["distance", "true range (m)"], ["level", "receive level (dBm)"]])
        if (left[name]) add(`Mean |error| over ${title}`, "bar", [bars("before", left[name].before_m, "--before"), bars("after", left[name].after_m, "--after")], title, "mean |error| (m)", { labels: middle(left[name].edges) });
      add("Worst links", "bar", [bars("before", left.links.slice(0, 20).map((one) => one.before_m), "--before"), bars("after", left.links.slice(0, 20).map((one) => one.after_m), "--after")], "link", "mean |error| (m)", { labels: left.links.slice(0, 20).map((one) => one.link) });
      add("Calibration: predicted against real error", "scatter", [{ label: "stretches of rows", data: left.calibration.predicted_m.map((x, at) => ({ x, y: left.calibration.error_m[at] })), backgroundColor: colour("--after"), pointRadius: 5 }], "predicted error (m)", "mean error (m)");
    } else section.append(make("p", "Predictions of single rows are not in this page."));
    if (entry.devices.length) {
      const table = make("table");
      table.append(make("caption", "Other devices, batch 1"));
      const head = make("tr");
      for (const title of ["Device", "Latency (µs)", "Energy (mJ)", "How obtained"]) head.append(make("th", title, { scope: "col", class: "text" }));
      table.append(head);
      for (const one of entry.devices) {
        const line = make("tr");
        const figure = (part) => (part ? `${three(part.value)} ${part.low === null ? "" : `(${three(part.low)} to ${three(part.high)})`}` : "–");
        for (const words of [one.device, figure(one.latency_us), figure(one.energy_mj), one.reason || one.how]) line.append(make("td", words, { class: "text" }));
        table.append(line);
      }
      const scroll = make("div", null, { class: "scroll", tabindex: "0", role: "region", "aria-label": "Devices, scrollable" });
      scroll.append(table);
      section.append(scroll);
    }
    if (entry.layers.length) {
      const list = make("ol");
      for (const [kind, macs, outputs, type] of entry.layers) list.append(make("li", `${kind}: ${macs.toLocaleString("en")} multiply-adds, ${outputs.toLocaleString("en")} outputs, ${type}`));
      const box = make("details");
      box.append(make("summary", `Network: ${entry.layers.length} kernels`), list);
      section.append(box);
    }
    for (const later of pending) later();
  }

  function draw() {
    while (charts.length) charts.pop().destroy();
    for (const section of document.querySelectorAll("[data-section]")) section.hidden = section.dataset.section !== state.view;
    for (const button of document.querySelectorAll("[data-view]")) button.setAttribute("aria-current", String(button.dataset.view === state.view));
    if (!data.boards.length) return;
    $("board").value = String(state.board);
    $("filter").value = state.filter;
    for (const box of document.querySelectorAll("#columns input")) box.checked = shown().some((one) => one.id === box.value);
    const one = board();
    $("summary").textContent = `${entries().length} of ${one.entries.length} runs. ` + (one.links
      ? `Ranks rest on ${one.links} links; a difference of ${fixed(one.detectable_m, 4)} m would be seen in four of five cases.` : `No ranks: ${one.no_ranks}.`);
    $("facts").replaceChildren(...[...one.facts, ...one.skipped.map((words) => `skipped: ${words}`)].map((words) => make("li", words)));
    if (state.view === "table") drawTable();
    if (state.view === "explorer") drawExplorer();
    if (state.view === "run") drawRun();
  }

  function start() {
    data.boards.forEach((one, at) => $("board").append(make("option", `${one.data}${one.simulated ? " (SIMULATED)" : ""}, ${one.split}`, { value: at })));
    for (const column of COLUMNS) {
      const label = make("label", null);
      const box = make("input", null, { type: "checkbox", value: column.id });
      label.append(box, ` ${column.title}`);
      $("columns").append(label);
      box.addEventListener("change", () => go({ columns: [...document.querySelectorAll("#columns input:checked")].map((each) => each.value) }));
    }
    $("board").addEventListener("change", (event) => go({ board: Number(event.target.value) }));
    $("filter").addEventListener("input", (event) => go({ filter: event.target.value }));
    $("cost").addEventListener("change", (event) => go({ cost: event.target.value }));
    for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", () => go({ view: button.dataset.view }));
    const dark = (on) => {
      document.documentElement.dataset.theme = on ? "dark" : "light";
      $("theme").setAttribute("aria-pressed", String(on));
    };
    dark(matchMedia("(prefers-color-scheme: dark)").matches);
    $("theme").addEventListener("click", () => { dark(document.documentElement.dataset.theme !== "dark"); draw(); });
    addEventListener("hashchange", () => { readHash(); draw(); });
    readHash();
    draw();
  }
  start();
})();
