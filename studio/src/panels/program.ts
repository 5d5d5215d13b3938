// What the actuator is to do, drawn by hand or planned to a state.
import { askOf, planned } from "../plan";
import { studio } from "../state.svelte";
import Program from "./Program.svelte";

export default {
  name: "program",
  title: "Program",
  place: "tab" as const,
  // A plan is recomputed for every design; this does not move the mechanism.
  follows: {
    type: "program",
    ask: () => {
      const plan = studio.way ? null : planned();
      return plan && askOf(plan);
    },
  },
  view: Program,
};
