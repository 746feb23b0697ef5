// The episode, from its lines as the page holds them (simulator/replay/page.py): an index, then one line for each step.

const MAX_LINES_KEPT = 50; // lines that are kept once they were read

// What the index has; line(step), the line of a step; solved(step), its decisions; trees(step), the explanations that were
// given with it; file(), the episode as its file has it; seen(step), where all impressions up to it were received, as believed at that step.
function openEpisode(text) {
  const [first, ...texts] = text.split("\n"), index = JSON.parse(first), lines = new Map();

  function line(step) {
    if (!lines.has(step)) {
      if (lines.size >= MAX_LINES_KEPT) lines.delete(lines.keys().next().value);
      lines.set(step, JSON.parse(texts[step]));
    }
    return lines.get(step);
  }
  function seen(step) {
    const anew = index.anew.filter((one) => one <= step).pop();
    return anew === undefined ? index.place.slice(0, step + 1) : [...line(anew).belief.seen_from, ...index.place.slice(anew + 1, step + 1)];
  }
  const file = () => [JSON.stringify(index.header), ...texts, ""].join("\n");
  return { ...index, line, seen, file, solved: (step) => line(step).belief.solved, trees: (step) => index.trees[step] || [] };
}
