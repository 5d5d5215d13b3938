// Where a replay begins: the page holds its motion, and asks nobody.
import { mount } from "svelte";
import Replay from "./Replay.svelte";
import "./studio.css";
import { studio } from "./state.svelte";
import { unpack } from "./wire";

const letters = atob(document.getElementById("motion")!.textContent!);
studio.replay(unpack(Uint8Array.from(letters, (one) => one.charCodeAt(0)).buffer));
mount(Replay, { target: document.getElementById("replay")! });
