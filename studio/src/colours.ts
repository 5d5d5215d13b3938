// The colours of the cells: Okabe and Ito's, told apart by every eye, in light and in dark.
const LIGHT = ["#0072b2", "#d55e00", "#009e73", "#b5568f", "#b37a00", "#3a94c9"];
const DARK = ["#56b4e9", "#e69f00", "#2fc89b", "#e28fbd", "#f0e442", "#ff8a4a"];

export const colour = (i: number, theme: "light" | "dark"): string =>
  theme === "dark" ? DARK[i % DARK.length] : LIGHT[i % LIGHT.length];
