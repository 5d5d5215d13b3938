// The panels in the order of the page; a panel is a module of one shape.
import type { Component } from "svelte";
import type { Follower } from "../state.svelte";
import atlas from "./atlas";
import cells from "./cells";
import graph from "./graph";
import map from "./map";
import measured from "./measured";
import mechanism from "./mechanism";
import motion from "./motion";
import parts from "./parts";
import prediction from "./prediction";
import program from "./program";
import robot from "./robot";
import study from "./study";
import summary from "./summary";
import wish from "./wish";
import yieldPanel from "./yield";

/** A panel: what of the server it follows, where it is, and how it looks. */
export interface Panel {
  name: string;
  title: string;
  /** A line at the top, a place in the middle, or behind a tab; robot: above the leg's panels. */
  place: "top" | "robot" | "middle" | "tab";
  /** What it asks whenever the design has changed, beside the cycle that is always asked. */
  follows?: Follower;
  /** Further types of requests by which it is filled: while one waits, the panel is marked as busy. */
  asks?: string[];
  view: Component;
}

export const panels: Panel[] = [
  summary,
  yieldPanel,
  prediction,
  robot,
  mechanism,
  motion,
  cells,
  graph,
  program,
  map,
  wish,
  parts,
  measured,
  study,
  atlas,
];
