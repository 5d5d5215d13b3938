// Recordings of a test machine beside what the design does.
import Measured from "./Measured.svelte";
import { recordings } from "./recordings.svelte";

export default {
  name: "measured",
  title: "Measured",
  place: "tab" as const,
  follows: {
    type: "measured",
    long: true,
    ask: () => recordings.asked,
  },
  view: Measured,
};
