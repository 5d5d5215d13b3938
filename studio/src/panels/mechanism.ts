// The drawing of the chain, whose anchors are dragged.
import { bandsOf } from "../design";
import { studio } from "../state.svelte";
import Mechanism from "./Mechanism.svelte";

export default {
  name: "mechanism",
  title: "Mechanism",
  place: "middle" as const,
  follows: {
    type: "curves",
    ask: () => (studio.cells.some((cell) => !bandsOf(cell).length) ? {} : null),
  },
  view: Mechanism,
};
