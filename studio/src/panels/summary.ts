// What the design does in a line: sequence, margin, peak force.
import { studio } from "../state.svelte";
import Summary from "./Summary.svelte";

export default {
  name: "summary",
  title: "Summary",
  place: "top" as const,
  // Where no closed form tells the margin it is searched aside; what follows past it waits for a still hand.
  follows: {
    type: "margin",
    long: true,
    ask: () => {
      const known = studio.limits;
      return !known || (known.margin && known.margin.becomes === undefined) ? {} : null;
    },
  },
  asks: ["evaluate", "limits"],
  view: Summary,
};
