// How many of those built with tolerances do what the drawing does.
import { tolerances } from "../tolerances.svelte";
import Yield from "./Yield.svelte";

export default {
  name: "yield",
  title: "Yield",
  place: "top" as const,
  follows: { type: "yield", long: true, ask: () => tolerances.asked },
  view: Yield,
};
