// The robot on its floor: its antennas, its arena, its walk.
import Robot from "./Robot.svelte";

export default {
  name: "robot",
  title: "Robot",
  place: "robot" as const,
  asks: ["robot", "arena", "arenas", "walk", "maze"],
  view: Robot,
};
