// The panels in the order of the page; a panel is a module of one shape.
import type { Component } from "svelte";
import graph from "./graph";
import mechanism from "./mechanism";
import motion from "./motion";

/** A panel: which answer of the server it shows, and how. */
export interface Panel {
  name: string;
  title: string;
  type: string;
  view: Component;
}

export const panels: Panel[] = [mechanism, motion, graph];
