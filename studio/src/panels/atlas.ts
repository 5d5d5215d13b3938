// The machines that a space of designs holds, as a map on which one walks from one to the next.
import Atlas from "./Atlas.svelte";

export default { name: "atlas", title: "Atlas", place: "tab" as const, view: Atlas };
