// The colours of the cells: on a light page those of the figures, a test compares them.
const LIGHT = [
  ...["#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a6a00", "#000000"],
  ...["#00704f", "#6f0a4f", "#855829", "#254782", "#403700", "#5c6975"],
];
const DARK = [
  ...["#2fc89b", "#e28fbd", "#f0b429", "#56b4e9", "#c9b64a", "#e8e6e1"],
  ...["#7fe3c3", "#f3bfdc", "#d9a66f", "#8fb4f5", "#d8cf8a", "#aab4be"],
];

export const colour = (i: number, theme: "light" | "dark"): string =>
  theme === "dark" ? DARK[i % DARK.length] : LIGHT[i % LIGHT.length];
