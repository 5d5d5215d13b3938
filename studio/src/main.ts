// Where the page begins.
import { mount } from "svelte";
import App from "./App.svelte";
import "./studio.css";
import { panels } from "./panels";
import { studio } from "./state.svelte";

mount(App, { target: document.getElementById("studio")! });
studio.types = [...new Set(panels.map(({ type }) => type))].filter((type) => type !== "evaluate");
studio.begin();
