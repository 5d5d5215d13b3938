// The colours of the cells, in the order that the figures have them and distinguishable with colour blindness.
// Loading and unloading keep Okabe and Ito's blue and vermillion for themselves.
const LIGHT = [
  ...["#009e73", "#b5568f", "#b37a00", "#2f86b8", "#7a6a00", "#1f2328"],
  ...["#00704f", "#6f0a4f", "#855829", "#254782", "#403700", "#5c6975"],
];
const DARK = [
  ...["#2fc89b", "#e28fbd", "#f0b429", "#56b4e9", "#c9b64a", "#e8e6e1"],
  ...["#7fe3c3", "#f3bfdc", "#d9a66f", "#8fb4f5", "#d8cf8a", "#aab4be"],
];

export const colour = (i: number, theme: "light" | "dark"): string =>
  theme === "dark" ? DARK[i % DARK.length] : LIGHT[i % LIGHT.length];
