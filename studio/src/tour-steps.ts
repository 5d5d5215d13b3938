// What the guided tour shows, in order. Each step waits for what it promises.

import { studio } from "./state.svelte";
import type { Step } from "./tour.svelte";

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
      await hand.watch(7000);
      await hand.press("Pause");
    },
  },
  {
    say: "The slider is the stroke. A snap is shown slowly; really it takes next to no time.",
    does: async (hand) => hand.slide("Stroke", 0.5, 4000),
  },
  {
    say: "Now one band is hooked in elsewhere: the outer cell goes first, both ways. This leg walks backward.",
    does: async (hand) => {
      await hand.slide("Stroke", 0, 300);
      await hand.drag("q of outer", -15, 0, 4000);
    },
    until: () => does("00>01>11>10>00"),
  },
  {
    say: "The discs say how far an anchor may be off before the order is another one. Undo brings the first one back.",
    does: async (hand) => hand.press("Undo"),
    until: () => does("00>10>11>01>00"),
  },
  {
    say: "These are all states in which it can stand. A click, and it goes there by its shortest program.",
    does: async (hand) => {
      await hand.press("Graph");
      await hand.press("Go to state 01");
    },
    until: () => studio.way?.arrives === "01",
  },
  {
    say: "That was the tour. Everything you saw can be dragged: try it.",
    does: async (hand) => hand.press("Back to the full cycle"),
    until: () => studio.way === null,
  },
];
