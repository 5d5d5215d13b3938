// The drawing of the chain, whose anchors are dragged.
import Mechanism from "./Mechanism.svelte";

export default {
  name: "mechanism",
  title: "Mechanism",
  place: "middle" as const,
  asks: ["evaluate"],
  view: Mechanism,
};
