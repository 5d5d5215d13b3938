// A design for a wanted cycle, or for a wanted set of states.
import Wish from "./Wish.svelte";

export default {
  name: "wish",
  title: "Target",
  place: "tab" as const,
  asks: ["wish"],
  view: Wish,
};
