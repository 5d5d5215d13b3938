// Something computed of many designs: begun, watched, stopped, opened.
import Study from "./Study.svelte";

export default {
  name: "study",
  title: "Study",
  place: "tab" as const,
  asks: ["study", "study_csv", "study_design", "study_estimate"],
  view: Study,
};
