// The solid parts of the chain, or of a robot, in a material: whether they can be built, and their files.
import { parts } from "../parts.svelte";
import { studio } from "../state.svelte";
import Parts from "./Parts.svelte";

export default {
  name: "parts",
  title: "Parts",
  place: "tab" as const,
  // The panel asks for the shapes by itself, while one drags.
  follows: { type: "build", long: true, ask: () => ({ material: parts.material, whole: studio.robot && parts.robot }) },
  asks: ["parts", "robot_parts", "build", "parts_files"],
  view: Parts,
};
