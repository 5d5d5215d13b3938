// Where the page begins.
import { mount } from "svelte";
import App from "./App.svelte";
import "./studio.css";
import { studio } from "./state.svelte";
import { tour } from "./tour.svelte";

mount(App, { target: document.getElementById("studio")! });
studio.begin();
const asked = new URLSearchParams(location.search).get("demo");
if (asked) void tour.begin(asked);
