// The curves of one full cycle, with one cursor.
import Motion from "./Motion.svelte";

export default {
  name: "motion",
  title: "Motion",
  place: "middle" as const,
  asks: ["evaluate"],
  view: Motion,
};
