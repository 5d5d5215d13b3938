// The graph classes of a space of designs, as a map with keyboard navigation.
import Atlas from "./Atlas.svelte";

export default {
  name: "atlas",
  title: "Atlas",
  place: "tab" as const,
  asks: ["atlas"],
  view: Atlas,
};
