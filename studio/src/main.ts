// Where the page begins.
import { mount } from "svelte";
import App from "./App.svelte";
import "./studio.css";
import { studio } from "./state.svelte";

mount(App, { target: document.getElementById("studio")! });
studio.begin();
