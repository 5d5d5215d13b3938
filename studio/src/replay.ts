// Where a replay begins: the page holds its motion, and asks nobody.
import { mount } from "svelte";
import { framed } from "./frame";
import Replay from "./Replay.svelte";
import { robot } from "./robot/robot.svelte";
import RobotReplay from "./RobotReplay.svelte";
import "./studio.css";
import { studio } from "./state.svelte";
import { type View, unpack } from "./wire";

async function held(): Promise<View> {
  const letters = atob(document.getElementById("motion")!.textContent!);
  const packed = new Blob([Uint8Array.from(letters, (one) => one.charCodeAt(0))]);
  const whole = packed.stream().pipeThrough(new DecompressionStream("deflate"));
  return unpack(await new Response(whole).arrayBuffer());
}

async function begin(): Promise<void> {
  document.documentElement.classList.toggle("framed", framed);
  const target = document.getElementById("replay")!;
  const view = await held();
  if (view.parts) {
    studio.dress();
    robot.replay(view);
    mount(RobotReplay, { target });
  } else {
    studio.replay(view);
    mount(Replay, { target });
  }
}

void begin();
