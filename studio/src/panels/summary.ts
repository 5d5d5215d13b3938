// What the design does in a line: sequence, margin, peak force.
import { studio } from "../state.svelte";
import Summary from "./Summary.svelte";

export default {
  name: "summary",
  title: "Summary",
  place: "top" as const,
  // Where no closed form tells the margin it is searched aside.
  follows: {
    type: "margin",
    long: true,
    ask: () => (studio.views.evaluate.method === "search" ? {} : null),
  },
  asks: ["evaluate"],
  view: Summary,
};
