// The colours of a robot's parts and of its bands.

import type { View } from "../wire";

// The colours of the figures, which a test compares; dark pages show ink in white.
const ROLES: Record<string, string> = {
  body: "#a8a8a8",
  carriage: "#d55e00",
  "middle block": "#0072b2",
  "outer block": "#009e73",
  lever: "#222222",
  link: "#cc79a7",
  foot: "#222222",
  antenna: "#e69f00",
  crank: "#e69f00",
  pin: "#8a8a8a",
  actuator: "#4d4d4d",
  battery: "#4d4d4d",
  support: "#a8a8a8",
};
const [INK, WHITE] = ["#222222", "#e8e6e1"];
// Tension of a band from slack to the greatest: the shades of the videos, and grey for a slack one.
const SHADES = ["#00244d", "#7d7a78", "#ffe838"];
const SLACK = "#bfbfbf";
// The darkest shade would not be seen on a dark page.
const shades = (dark: boolean): string[] => (dark ? ["#2a5a94", ...SHADES.slice(1)] : SHADES);
/** The shades as a gradient of CSS. */
export const gradient = (dark: boolean): string => `linear-gradient(90deg, ${shades(dark).join(", ")})`;

type RGB = [number, number, number];
const rgb = (hex: string): RGB => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255) as RGB;
/** A colour between two others. */
const mixed = (a: RGB, b: RGB, share: number): RGB => a.map((one, k) => one + (b[k] - one) * share) as RGB;

// Parts that are pointed at, and parts that overlap.
const [POINTED, STRUCK] = [rgb("#fff28c"), rgb("#ff2a2a")];

/** The colour of a part by its role. */
export const roleColour = (role: string, dark: boolean): string =>
  dark && ROLES[role] === INK ? WHITE : (ROLES[role] ?? ROLES.body);

/** The roles of the parts of a view, in the order of their colours. */
export const rolesOf = (view: View): string[] => {
  const used = new Set(view.parts.map((one: { role: string }) => one.role));
  return Object.keys(ROLES).filter((role) => used.has(role));
};

/** Red, green and blue, 0 to 1, of something drawn; a band has a tension, 0 to 1. */
export function shownColour(role: string, dark: boolean, tension: number | null): RGB {
  if (tension === null) return rgb(role === "cords" ? (dark ? WHITE : INK) : roleColour(role, dark));
  if (tension <= 0) return rgb(SLACK);
  const at = Math.min(tension, 1) * (SHADES.length - 1);
  const k = Math.min(Math.floor(at), SHADES.length - 2);
  const [a, b] = shades(dark).slice(k, k + 2).map(rgb);
  return mixed(a, b, at - k);
}

/** The colour of a part under the pointer, and of parts that overlap. */
export const marked = (colour: RGB, pointed: boolean, struck: boolean): RGB =>
  pointed ? mixed(colour, POINTED, 0.6) : struck ? mixed(colour, STRUCK, 0.85) : colour;
