// What the chain does for all values of two of its parameters; it asks by itself, while one drags.
import Map from "./Map.svelte";

export default {
  name: "map",
  title: "Map",
  place: "tab" as const,
  asks: ["map", "border", "map_followed", "parameters", "jump"],
  view: Map,
};
