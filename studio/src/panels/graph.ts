// The states in which the chain can stand, and what leads from one to another.
import Graph from "./Graph.svelte";

export default {
  name: "graph",
  title: "Graph",
  place: "tab" as const,
  follows: { type: "graph" },
  view: Graph,
};
