// What the guided tour shows, in order. Each step waits for what it promises.

import { studio } from "./state.svelte";
import { type Step, isThere } from "./tour.svelte";

const does = (sequence: string): boolean =>
  !studio.busy && studio.views.evaluate?.sequence === sequence;

export const STEPS: Step[] = [
  {
    say: "These are mechanisms that snap. Let us open the one that makes a robot walk.",
    does: async (hand) => {
      if (!studio.gallery) await hand.press("Gallery");
      await hand.press("Forward leg: clockwise, the inner cell moves first both ways");
    },
    until: () => does("00>10>11>01>00"),
  },
  {
    say: "Two cells in a row, a rubber band in each. An actuator pulls at the right end, and pushes back.",
    does: async (hand) => {
      await hand.press("Play");
      await hand.watch(6000);
      await hand.press("Pause");
    },
  },
  {
    say: "The slider is the stroke. Snaps are shown in slow motion; a real snap takes milliseconds.",
    does: async (hand) => hand.slide("Stroke", 0.5, 3000),
  },
  {
    say: "Now one anchor is moved, and the outer cell snaps first. This leg walks backward.",
    does: async (hand) => {
      await hand.slide("Stroke", 0, 300);
      await hand.drag("q of outer", 0, -15, 3500);
    },
    until: () => does("00>01>11>10>00"),
  },
  {
    say: "Each disc is the margin of an anchor: a larger displacement changes the sequence. Now back again.",
    does: async (hand) => hand.press("Undo"),
    until: () => does("00>10>11>01>00"),
  },
  {
    say: "The graph shows all stable states. A click plans the shortest program to a state.",
    does: async (hand) => {
      await hand.press("Graph");
      await hand.press("Go to state 01");
    },
    until: () => studio.way?.arrives === "01",
  },
  {
    say: "A program is a list of turning points of the actuator. Drag one, and the final state may change.",
    does: async (hand) => {
      await hand.press("Program");
      await hand.drag("Turn 1", 0, 70, 2500);
      await hand.press("Back to the full cycle");
    },
    until: () => studio.way === null,
  },
  {
    say: "A map of the sequences for every position of that anchor, with exact boundaries. A click moves the design there.",
    does: async (hand) => {
      await hand.press("Map");
      await hand.point("Map over x of q of outer and y of q of outer", 0.42, 0.2);
    },
    until: () => does("00>10>11>10>00"),
  },
  {
    say: "Inverse design: give a target sequence, state by state, and a design is computed for it.",
    does: async (hand) => {
      await hand.press("Target");
      for (const state of ["00", "01", "11", "10", "00"]) await hand.press(`State ${state}`);
      await hand.press("Find a design");
      await hand.press("Use this design");
    },
    until: () => does("00>01>11>10>00"),
  },
  {
    say: "It comes with its yield: the fraction of samples within tolerance that have the same sequence.",
    until: () => studio.fresh.has("yield"),
  },
  {
    say: "Two such legs walk. When an antenna meets a wall, it moves an anchor, and the robot turns away.",
    does: async (hand) => {
      await hand.press("Gallery");
      await hand.press("Robot with antennas that finds its way past walls");
      await hand.write("Arena", "wall");
      await hand.write("Time limit in s", "60");
      await hand.press("Through the arena");
      await hand.find("outcome");
      await hand.watch(9000);
    },
    until: () => isThere("outcome"),
  },
  {
    say: "The robot has no computer on board. The design is also available as Python code.",
    does: async (hand) => {
      await hand.press("Show me the Python");
      await hand.watch(4000);
      await hand.press("Close");
    },
  },
  { say: "That was the tour. All parts of the page can be dragged: try it." },
];
